// Time, memory, and the table in which the comparisons are printed.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace scancal::bench {

// Processor seconds of this process. What others do on the machine meanwhile does not count as time of either side.
double ProcessorSeconds();

double SecondsOf(const std::function<void()>& work);  // once
// Medians of several works that take turns, so that whatever slows the machine for a while slows all of them: at least
// nine rounds, and as many as fit into a third of a second for each.
std::vector<double> MedianSecondsOf(const std::vector<std::function<void()>>& works);
double MedianSecondsOf(const std::function<void()>& work);

struct ChildRun {
  std::vector<double> values;  // what the work returned
  double peak_mb = 0;          // most resident memory while it ran, less what was resident when it began
};
// Runs the work in a child of its own, so that nothing that was freed before is used again unseen.
ChildRun RunInChild(const std::function<std::vector<double>()>& work);

struct Line {
  std::string what, ours, other, ratio, claim, holds;
};

class Table {
 public:
  void Note(const std::string& note) { notes_.push_back(note); }  // printed below the lines
  void Add(Line line);
  // Two times. at_least: the claimed ratio other / ours; 0: nothing is claimed.
  void AddTimes(const std::string& what, double ours_s, double other_s, double at_least);
  // A number that is claimed to be at most `at_most`.
  void AddAtMost(const std::string& what, const std::string& ours, const std::string& other, const std::string& ratio,
                 double value, double at_most);
  void Print() const;  // Markdown, readable as it is, to standard output

 private:
  std::vector<Line> lines_;
  std::vector<std::string> notes_;
};

std::string Seconds(double seconds);        // "23.9 s", "0.61 ms", "430 ns"
std::string Ratio(double ratio);            // "41,000", "12.3", "0.91"
void Say(const std::string& what_is_done);  // progress, to standard error

}  // namespace scancal::bench

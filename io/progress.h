// A progress bar on the terminal; where standard error is none, a line every ten seconds.
#pragma once
#include <chrono>
#include <string>

namespace scancal {

class Progress {
 public:
  // "reading left.csv". between_lines: where standard error is no terminal.
  explicit Progress(std::string label, std::chrono::duration<double> between_lines = std::chrono::seconds(10));
  ~Progress();  // wipes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void Show(double fraction);  // 0..1, any thread at a time; redraws a bar at most ten times a second

 private:
  std::string label_;
  bool terminal_;
  std::chrono::duration<double> between_lines_;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace scancal

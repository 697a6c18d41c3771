#include "tests/bench/measure.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>

namespace scancal::bench {
namespace {

constexpr double kMegabyte = 1e6;
constexpr int kFewestRounds = 9, kMostRounds = 1000;
constexpr double kEnoughSeconds = 0.3;

double ResidentMegabytes() {
  double size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / kMegabyte;
}

double PeakResidentMegabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024 / kMegabyte;
}

void WriteAll(int file, const double* values, size_t count) {
  const ssize_t bytes = static_cast<ssize_t>(count * sizeof(double));
  PCHECK(::write(file, values, count * sizeof(double)) == bytes);
}

}  // namespace

double ProcessorSeconds() {
  timespec now{};
  PCHECK(::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double SecondsOf(const std::function<void()>& work) {
  const double began = ProcessorSeconds();
  work();
  return ProcessorSeconds() - began;
}

std::vector<double> MedianSecondsOf(const std::vector<std::function<void()>>& works) {
  for (const auto& work : works) work();  // once unmeasured: pages and caches as they will be
  std::vector<std::vector<double>> seconds(works.size());
  const double enough = ProcessorSeconds() + kEnoughSeconds * static_cast<double>(works.size());
  for (int round = 0; round < kFewestRounds || (round < kMostRounds && ProcessorSeconds() < enough); ++round)
    for (size_t k = 0; k < works.size(); ++k) seconds[k].push_back(SecondsOf(works[k]));
  std::vector<double> medians;
  for (auto& list : seconds) {
    const auto middle = list.begin() + std::ssize(list) / 2;
    std::nth_element(list.begin(), middle, list.end());
    medians.push_back(*middle);
  }
  return medians;
}

double MedianSecondsOf(const std::function<void()>& work) { return MedianSecondsOf(std::vector{work}).front(); }

ChildRun RunInChild(const std::function<std::vector<double>()>& work) {
  std::fflush(nullptr);
  ::malloc_trim(0);  // free memory of ours would hide what the child takes
  std::array<int, 2> ends{};
  PCHECK(::pipe(ends.data()) == 0);
  const pid_t child = ::fork();
  PCHECK(child >= 0);
  if (child == 0) {
    const double before = ResidentMegabytes();
    const std::vector<double> values = work();
    const double peak = PeakResidentMegabytes() - before;
    WriteAll(ends[1], &peak, 1);
    WriteAll(ends[1], values.data(), values.size());
    ::_exit(0);
  }
  ::close(ends[1]);
  std::vector<double> read;
  double value = 0;
  while (::read(ends[0], &value, sizeof value) == static_cast<ssize_t>(sizeof value)) read.push_back(value);
  ::close(ends[0]);
  int status = 0;
  PCHECK(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0 && !read.empty()) << "the child failed (out of memory?)";
  return {{read.begin() + 1, read.end()}, read.front()};
}

void Table::Add(Line line) {
  Say(fmt::format("  {}: {} | {} | {}", line.what, line.ours, line.other, line.ratio));
  lines_.push_back(std::move(line));
}

void Table::AddTimes(const std::string& what, double ours_s, double other_s, double at_least) {
  const double ratio = other_s / ours_s;
  Add({what, Seconds(ours_s), Seconds(other_s), Ratio(ratio), at_least > 0 ? "at least " + Ratio(at_least) : "",
       at_least > 0 ? (ratio >= at_least ? "yes" : "NO") : ""});
}

void Table::AddAtMost(const std::string& what, const std::string& ours, const std::string& other,
                      const std::string& ratio, double value, double at_most) {
  Add({what, ours, other, ratio, fmt::format("at most {:.3g}", at_most), value <= at_most ? "yes" : "NO"});
}

void Table::Print() const {
  std::vector<std::array<std::string, 6>> cells = {{"what", "ours", "other", "ratio", "claim", "holds"}};
  for (const Line& line : lines_)
    cells.push_back({line.what, line.ours, line.other, line.ratio, line.claim, line.holds});
  std::array<size_t, 6> width{};
  for (const auto& row : cells)
    for (size_t k = 0; k < width.size(); ++k) width[k] = std::max(width[k], row[k].size());
  for (size_t i = 0; i < cells.size(); ++i) {
    for (size_t k = 0; k < width.size(); ++k) fmt::print("| {:<{}} ", cells[i][k], width[k]);
    fmt::print("|\n");
    if (i > 0) continue;
    for (const size_t w : width) fmt::print("| {} ", std::string(w, '-'));
    fmt::print("|\n");
  }
  fmt::print("\n");
  for (const std::string& note : notes_) fmt::print("- {}\n", note);
}

std::string Seconds(double seconds) {
  if (seconds >= 1) return fmt::format("{:.3g} s", seconds);
  if (seconds >= 1e-3) return fmt::format("{:.3g} ms", 1e3 * seconds);
  if (seconds >= 1e-6) return fmt::format("{:.3g} us", 1e6 * seconds);
  return fmt::format("{:.3g} ns", 1e9 * seconds);
}

std::string Ratio(double ratio) {
  if (ratio < 1000) return fmt::format("{:.3g}", ratio);
  // Three digits, thousands apart.
  const double unit = std::pow(10, std::floor(std::log10(ratio)) - 2);
  std::string text = fmt::format("{:.0f}", std::round(ratio / unit) * unit);
  for (auto k = std::ssize(text) - 3; k > 0; k -= 3) text.insert(static_cast<size_t>(k), ",");
  return text;
}

void Say(const std::string& what_is_done) { fmt::print(stderr, "{}\n", what_is_done); }

}  // namespace scancal::bench

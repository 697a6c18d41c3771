// A progress bar on the terminal; silent where standard error is not one.
#pragma once
#include <chrono>
#include <string>

namespace scancal {

class Progress {
 public:
  explicit Progress(std::string label);  // "reading left.csv"
  ~Progress();                           // wipes the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void Show(double fraction);  // 0..1, any thread at a time; redraws at most ten times a second, with the time left

 private:
  std::string label_;
  bool terminal_;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace scancal

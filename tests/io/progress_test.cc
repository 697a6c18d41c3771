#include "io/progress.h"
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <thread>

namespace scancal {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool HasTerminal() {
  int ends[2] = {};
  if (::openpty(&ends[0], &ends[1], nullptr, nullptr, nullptr) != 0) return false;
  for (const int end : ends) ::close(end);
  return true;
}

// What `show` writes to standard error, which is a terminal of this width, or a pipe if the width is 0.
std::string Output(unsigned short width, const std::function<void()>& show) {
  int ends[2] = {};
  winsize size = {};
  size.ws_col = width;
  size.ws_row = 24;
  EXPECT_EQ(width > 0 ? ::openpty(&ends[0], &ends[1], nullptr, nullptr, &size) : ::pipe(ends), 0);
  const int standard_error = ::dup(STDERR_FILENO);
  ::dup2(ends[1], STDERR_FILENO);
  show();
  ::dup2(standard_error, STDERR_FILENO);
  ::close(standard_error);
  ::fcntl(ends[0], F_SETFL, O_NONBLOCK);
  std::string output;
  std::array<char, 4096> part = {};
  ssize_t count = 0;
  while ((count = ::read(ends[0], part.data(), part.size())) > 0)
    output.append(part.data(), static_cast<size_t>(count));
  ::close(ends[0]);
  ::close(ends[1]);
  return output;
}

TEST(ProgressTest, DrawsLabelBarPercentAndTimeLeftAndWipesThem) {
  if (!HasTerminal()) GTEST_SKIP() << "NO TERMINAL: /dev/pts is not there";
  const std::string output = Output(100, [] {
    Progress progress("reading left.csv");
    std::this_thread::sleep_for(milliseconds(400));
    progress.Show(0.5);
  });
  EXPECT_THAT(output,
              AllOf(HasSubstr("reading left.csv [###############               ]  50 % 1 s left"), EndsWith("\x1b[K")));
}

TEST(ProgressTest, RedrawsAtMostTenTimesASecond) {
  if (!HasTerminal()) GTEST_SKIP() << "NO TERMINAL: /dev/pts is not there";
  const std::string output = Output(100, [] {
    Progress progress("x");
    const auto end = std::chrono::steady_clock::now() + milliseconds(750);
    while (std::chrono::steady_clock::now() < end) progress.Show(0.25);
  });
  const auto redraws = std::count(output.begin(), output.end(), '%');
  EXPECT_GE(redraws, 2);
  EXPECT_LE(redraws, 5);
}

TEST(ProgressTest, WhatEndsSoonDrawsNothing) {
  if (!HasTerminal()) GTEST_SKIP() << "NO TERMINAL: /dev/pts is not there";
  EXPECT_THAT(Output(100,
                     [] {
                       Progress progress("x");
                       progress.Show(0.5);
                       progress.Show(1);
                     }),
              IsEmpty());
}

TEST(ProgressTest, ALineNowAndThenWhereStandardErrorIsNoTerminal) {
  const std::string output = Output(0, [] {
    Progress progress("reading", milliseconds(200));
    for (const double fraction : {0.25, 0.5}) {
      std::this_thread::sleep_for(milliseconds(250));
      progress.Show(fraction);
      progress.Show(fraction);
    }
  });
  EXPECT_EQ(output, "reading: 25 %, 1 s left\nreading: 50 %, 1 s left\n");
}

TEST(ProgressTest, NothingOfWhatEndsSoonWhereStandardErrorIsNoTerminal) {
  EXPECT_THAT(Output(0,
                     [] {
                       Progress progress("x");
                       std::this_thread::sleep_for(milliseconds(400));
                       progress.Show(0.5);
                     }),
              IsEmpty());
}

TEST(ProgressTest, ALineIsNeverWiderThanTheTerminal) {
  if (!HasTerminal()) GTEST_SKIP() << "NO TERMINAL: /dev/pts is not there";
  const std::string output = Output(20, [] {
    Progress progress("a label of thirty-odd characters");
    std::this_thread::sleep_for(milliseconds(400));
    progress.Show(2);  // and what is beyond the end is the end
  });
  EXPECT_THAT(output, HasSubstr("a label of thirty-o\x1b[K"));
}

}  // namespace
}  // namespace scancal

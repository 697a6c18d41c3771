// The program as a user runs it: arguments go to it as they are, no shell in between.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace scancal {

struct Outcome {
  int exit_code = -1;  // -1: ended by a signal
  int signal = 0;
  std::string out, err;
};

inline void PrintTo(const Outcome& outcome, std::ostream* stream) {
  *stream << "exit code " << outcome.exit_code << ", signal " << outcome.signal << "\nstdout:\n"
          << outcome.out << "\nstderr:\n"
          << outcome.err;
}

struct Surroundings {
  std::filesystem::path folder = {};        // the current folder of the program; empty: that of the test
  std::optional<rlim_t> largest_file = {};  // bytes; more fails like a full disk
  std::filesystem::path input = {};         // standard input; empty: nothing
};

// A running scancal. Its output goes to files without a name, so that no pipe can fill up.
class RunningProgram {
 public:
  explicit RunningProgram(const std::vector<std::string>& arguments, const Surroundings& surroundings = {})
      : out_(OpenNameless()), err_(OpenNameless()) {
    std::vector<std::string> words = {SCANCAL_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) Become(pointers.data(), surroundings);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    ::close(out_);
    ::close(err_);
  }

  void Signal(int signal) const { ::kill(pid_, signal); }

  // True once it has ended, which Wait() then tells about.
  bool HasEnded() const {
    siginfo_t info = {};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == pid_;
  }

  Outcome Wait() {
    int status = 0;
    Outcome outcome;
    if (pid_ > 0 && ::waitpid(pid_, &status, 0) == pid_) {
      if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
      if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
    }
    pid_ = -1;
    outcome.out = Contents(out_);
    outcome.err = Contents(err_);
    return outcome;
  }

 private:
  static int OpenNameless() { return ::open(std::filesystem::temp_directory_path().c_str(), O_TMPFILE | O_RDWR, 0600); }

  static std::string Contents(int descriptor) {
    std::string text;
    char buffer[4096];
    ::lseek(descriptor, 0, SEEK_SET);
    for (ssize_t count; (count = ::read(descriptor, buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<size_t>(count));
    return text;
  }

  // In the child: nothing here allocates.
  [[noreturn]] void Become(char* const* words, const Surroundings& surroundings) const {
    const int input = ::open(surroundings.input.empty() ? "/dev/null" : surroundings.input.c_str(), O_RDONLY);
    bool ready = ::dup2(input, 0) == 0 && ::dup2(out_, 1) == 1 && ::dup2(err_, 2) == 2;
    if (!surroundings.folder.empty()) ready = ready && ::chdir(surroundings.folder.c_str()) == 0;
    if (surroundings.largest_file) {
      const rlimit limit = {*surroundings.largest_file, *surroundings.largest_file};
      ready = ready && ::setrlimit(RLIMIT_FSIZE, &limit) == 0 && ::signal(SIGXFSZ, SIG_IGN) != SIG_ERR;
    }
    if (ready) ::execv(words[0], words);
    ::_exit(127);
  }

  int out_, err_;
  pid_t pid_ = -1;
};

inline Outcome RunScancal(const std::vector<std::string>& arguments, const Surroundings& surroundings = {}) {
  return RunningProgram(arguments, surroundings).Wait();
}

// "scancal: left.csv:5: ..." -> "left.csv:5: ..."; a failure of the test if that is not all that was said.
inline std::string OneSentence(const Outcome& outcome) {
  const std::string& text = outcome.err;
  const std::string before = "scancal: ";
  const bool one_line = !text.empty() && text.find('\n') == text.size() - 1;
  EXPECT_TRUE(one_line && text.starts_with(before) && text.size() > before.size() + 10)
      << "expected one sentence after \"scancal: \" on stderr, found " << ::testing::PrintToString(outcome);
  return text.size() > before.size() + 1 ? text.substr(before.size(), text.size() - before.size() - 1) : text;
}

}  // namespace scancal

#include "report/page.h"
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

namespace scancal {
namespace {

namespace fs = std::filesystem;

// A child that ends without reading all of it has its own reason, which its exit status tells.
void SendAll(int to, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = send(to, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;
    text.remove_prefix(static_cast<size_t>(sent));
  }
}

// The exit status of a program that reads `input` and uses this one's standard output and error.
Result<int> Run(std::vector<std::string> command, const std::string& input) {
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return Error{command[0] + ": " + std::strerror(errno)};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) SendAll(ends[0], input);
  close(ends[0]);
  if (error)
    return Error{command[0] + ": " + std::strerror(error) +
                 "; the report needs Python 3 with Jinja2 and Matplotlib: install python3-jinja2 and "
                 "python3-matplotlib, or name a Python that has them in the environment variable SCANCAL_PYTHON"};
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return Error{command[0] + ": " + std::strerror(errno)};
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

fs::path FromEnvironment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// What makes the page lies where the program lies, and moves with it.
struct Maker {
  fs::path folder;      // Python's program
  fs::path kept_fonts;  // empty: they are cut anew for each page
};

Result<Maker> FindMaker() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error), beside = program.parent_path();
  const fs::path installed = beside.parent_path() / "share/scancal/page", built = beside / "share/scancal/page";
  if (fs::exists(built / "__main__.py", error)) return Maker{built, beside / "fonts.css"};
  if (fs::exists(installed / "__main__.py", error)) {
    fs::path cache = FromEnvironment("XDG_CACHE_HOME");
    if (cache.is_relative() && !FromEnvironment("HOME").empty()) cache = FromEnvironment("HOME") / ".cache";
    return Maker{installed, cache.is_relative() ? "" : cache / "scancal/fonts.css"};
  }
  return Error{installed.string() + ": no such folder, but it makes the report; move the whole installation, not the " +
               "program alone, or install again"};
}

// Debian's Python has what Debian's packages bring; the first of the PATH may be another.
std::string Python() {
  const std::string named = FromEnvironment("SCANCAL_PYTHON");
  if (!named.empty()) return named;
  return access(SCANCAL_PYTHON, X_OK) == 0 ? SCANCAL_PYTHON : "python3";
}

}  // namespace

Result<bool> WritePage(const std::filesystem::path& calibration, const Json& figures, const PageChoice& choice) {
  SCANCAL_ASSIGN_OR_RETURN(const Maker maker, FindMaker());
  std::vector<std::string> command = {Python(), "-B", maker.folder, "--language=" + choice.language};
  for (const auto& [flag, file] : {std::pair{"--out=", &choice.html},
                                   {"--pdf=", &choice.pdf},
                                   {"--dcc=", &choice.dcc},
                                   {"--previous=", &choice.previous},
                                   {"--fonts=", &maker.kept_fonts}})
    if (!file->empty()) command.push_back(flag + file->string());
  command.insert(command.end(), {"--figures", "--", calibration.string()});
  SCANCAL_ASSIGN_OR_RETURN(const int status, Run(std::move(command), figures.dump()));
  return status == 0;
}

Result<bool> WriteHistoryPage(const Json& history, const std::filesystem::path& html, const std::string& language) {
  SCANCAL_ASSIGN_OR_RETURN(const Maker maker, FindMaker());
  std::vector<std::string> command = {Python(), "-B", maker.folder / "history.py", "--language=" + language,
                                      "--out=" + html.string()};
  if (!maker.kept_fonts.empty()) command.push_back("--fonts=" + maker.kept_fonts.string());
  SCANCAL_ASSIGN_OR_RETURN(const int status, Run(std::move(command), history.dump()));
  return status == 0;
}

}  // namespace scancal

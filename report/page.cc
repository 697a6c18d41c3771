#include "report/page.h"
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

namespace scancal {
namespace {

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
  const int error = posix_spawn(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) SendAll(ends[0], input);
  close(ends[0]);
  if (error)
    return Error{command[0] + ": " + std::strerror(error) + "; the report needs Python 3: scripts/setup installs it"};
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return Error{command[0] + ": " + std::strerror(errno)};
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Result<bool> WritePage(const std::filesystem::path& calibration, const Json& figures, const PageChoice& choice) {
  std::vector<std::string> command = {SCANCAL_PYTHON, "-B", SCANCAL_PAGE, "--language=" + choice.language};
  for (const auto& [flag, file] : {std::pair{"--out=", &choice.html},
                                   {"--pdf=", &choice.pdf},
                                   {"--dcc=", &choice.dcc},
                                   {"--previous=", &choice.previous}})
    if (!file->empty()) command.push_back(flag + file->string());
  command.insert(command.end(), {"--fonts=" SCANCAL_FONTS, "--figures", "--", calibration.string()});
  SCANCAL_ASSIGN_OR_RETURN(const int status, Run(std::move(command), figures.dump()));
  return status == 0;
}

}  // namespace scancal

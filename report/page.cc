#include "report/page.h"
#include <spawn.h>
#include <sys/wait.h>
#include <cerrno>
#include <cstring>
#include <vector>

namespace scancal {
namespace {

// The exit status of a program that uses this one's standard streams.
Result<int> Run(std::vector<std::string> command) {
  std::vector<char*> arguments;
  for (std::string& argument : command) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (const int error = posix_spawn(&child, arguments[0], nullptr, nullptr, arguments.data(), environ))
    return Error{command[0] + ": " + std::strerror(error) + "; the report needs Python 3: scripts/setup installs it"};
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return Error{command[0] + ": " + std::strerror(errno)};
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Result<bool> WritePage(const std::filesystem::path& calibration, const PageChoice& choice) {
  std::vector<std::string> command = {SCANCAL_PYTHON, "-B", SCANCAL_PAGE, "--language=" + choice.language};
  for (const auto& [flag, file] : {std::pair{"--out=", &choice.html},
                                   {"--pdf=", &choice.pdf},
                                   {"--dcc=", &choice.dcc},
                                   {"--previous=", &choice.previous}})
    if (!file->empty()) command.push_back(flag + file->string());
  command.insert(command.end(), {"--", calibration.string()});
  SCANCAL_ASSIGN_OR_RETURN(const int status, Run(std::move(command)));
  return status == 0;
}

}  // namespace scancal

// scancal: calibration of 3D scanners from geometric targets.
#include <fcntl.h>
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <glog/logging.h>
#include <malloc.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cstdio>
#include <cstring>
#include "apps/command.h"
#include "io/file_kind.h"
#include "report/text.h"

DECLARE_bool(help);
DECLARE_bool(version);

namespace scancal {
namespace {

const Command* const kCommands[] = {&kRefineCommand,    &kMonteCarloCommand, &kCompareCommand, &kSimulateCommand,
                                    &kTransformCommand, &kPropagateCommand,  &kUrdfCommand,    &kReportCommand,
                                    &kRecheckCommand,   &kDiffCommand,       &kHistoryCommand, &kVerifyCommand,
                                    &kConvertCommand,   &kPlanesCommand,     &kSelftestCommand};
std::string command_line;

void PrintOverview() {
  std::printf("scancal %s: calibration of 3D scanners, with its uncertainty\n\nusage: scancal COMMAND [flags]\n\n",
              SCANCAL_VERSION);
  for (const Command* command : kCommands)
    std::printf("  %-10s %-11s %s\n", command->name, command->arguments, command->summary);
  std::printf("\nscancal COMMAND --help lists the flags of a command.\n");
}

void PrintHelp(const Command& command) {
  std::printf("usage: scancal %s %s [flags]\n\n%s\n\n", command.name, command.arguments, command.summary);
  for (const CommandFlag& flag : command.flags) {
    const auto info = gflags::GetCommandLineFlagInfoOrDie(flag.name);
    // gflags prints doubles with 17 digits.
    const std::string preset =
        info.type == "double" ? fmt::format("{}", std::stod(info.default_value)) : info.default_value;
    const std::string shown = info.type == "bool" ? info.name : info.name + "=" + info.type;
    fmt::print("  --{:<24} {}{}\n", shown, flag.meaning ? flag.meaning : info.description,
               preset.empty() ? "" : " (default " + preset + ")");
  }
}

bool Has(const Command& command, const std::string& flag) {
  return std::any_of(command.flags.begin(), command.flags.end(), [&](const auto& own) { return own.name == flag; });
}

// A flag that belongs to another command would be ignored: say so.
int RefuseForeignFlags(const Command& command) {
  for (const Command* other : kCommands)
    for (const auto& [flag, meaning] : other->flags)
      if (!Has(command, flag) && !gflags::GetCommandLineFlagInfoOrDie(flag).is_default)
        return Complain(std::string("--") + flag + " is no flag of " + command.name + "; see scancal " + command.name +
                        " --help");
  return kTrusted;
}

// As a shell takes it back.
std::string ShellQuoted(const std::string& argument) {
  static constexpr char kPlain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) return argument;
  std::string quoted = "'";
  for (const char c : argument) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

int Main(int argc, char** argv) {
  // Where the standard input is closed the next file to be opened would become it.
  if (::fcntl(STDIN_FILENO, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) < 0) return kBadInput;
  for (int i = 0; i < argc; ++i) command_line += (i ? " " : "") + ShellQuoted(argv[i]);
  // A fit takes matrices of the same sizes again and again: kept here, or the system clears them anew every time.
  constexpr int kKept = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kKept);
  mallopt(M_TRIM_THRESHOLD, kKept);
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::GLOG_WARNING;
  google::InitGoogleLogging(argv[0]);
  gflags::ParseCommandLineNonHelpFlags(&argc, &argv, true);
  if (FLAGS_version) {
    const std::string also = OptionalFileKinds();
    std::printf("scancal %s%s%s\n", SCANCAL_VERSION, also.empty() ? "" : ", reads also ", also.c_str());
    return kTrusted;
  }
  if (argc < 2) {
    PrintOverview();
    return FLAGS_help ? kTrusted : kBadInput;
  }
  for (const Command* command : kCommands) {
    if (std::strcmp(argv[1], command->name) != 0) continue;
    if (FLAGS_help) {
      PrintHelp(*command);
      return kTrusted;
    }
    if (const int refused = RefuseForeignFlags(*command)) return refused;
    const int code = command->run({argv + 2, argv + argc});
    if (std::fflush(stdout) != 0 || std::ferror(stdout)) return Complain("standard output could not be written");
    return code;
  }
  PrintOverview();
  return Complain(std::string("found command \"") + argv[1] + "\", expected one of those above");
}

}  // namespace

void Print(const std::string& text) {
  constexpr size_t kColumns = 100;
  winsize window{};
  const bool terminal = isatty(STDOUT_FILENO) && ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0;
  const std::string shown = terminal ? Wrapped(text, std::min<size_t>(kColumns, window.ws_col)) : text;
  std::fwrite(shown.data(), 1, shown.size(), stdout);
}

int Complain(const std::string& sentence) {
  std::fflush(stdout);
  std::fprintf(stderr, "scancal: %s\n", sentence.c_str());
  return kBadInput;
}

std::string CommandLine() { return command_line; }

}  // namespace scancal

int main(int argc, char** argv) { return scancal::Main(argc, argv); }

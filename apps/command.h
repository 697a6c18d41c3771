// One command of the program.
#pragma once
#include <string>
#include <vector>
#include "io/result.h"

namespace scancal {

struct CommandFlag {
  const char* name;
  const char* meaning = nullptr;  // where several commands share the flag; else its own description
};

struct Command {
  const char* name;
  const char* arguments;                                  // "DATASET"
  const char* summary;                                    // one line
  std::vector<CommandFlag> flags;                         // its own, in the order of its help
  int (*run)(const std::vector<std::string>& arguments);  // exit code
};

extern const Command kRefineCommand, kMonteCarloCommand, kCompareCommand, kSimulateCommand, kTransformCommand,
    kPropagateCommand, kUrdfCommand, kReportCommand, kRecheckCommand, kDiffCommand, kHistoryCommand, kVerifyCommand,
    kConvertCommand, kPlanesCommand, kSelftestCommand;

// Exit codes.
inline constexpr int kTrusted = 0, kBadInput = 1, kUnreliable = 2;
inline constexpr int kFoundOut = kUnreliable;  // a command that asks whether all is well: it is not

// To standard output; on a terminal, sentences in lines of at most 100 columns.
void Print(const std::string& text);
int Complain(const std::string& sentence);  // to standard error; returns kBadInput
std::string CommandLine();                  // as typed, quoted where a shell needs it
Result<void> CheckLanguage();               // that --language is one that the page of the report speaks

}  // namespace scancal

// scancal selftest
#include "models/selftest/selftest.h"
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/command.h"
#include "report/text.h"

DEFINE_string(nist, "", "folder with the 27 .dat files of NIST's certified nonlinear regressions, to run these too");

namespace scancal {
namespace {

int RunSelftest(const std::vector<std::string>& arguments) {
  if (!arguments.empty()) return Complain("selftest takes no argument; the folder of NIST's files is given by --nist");
  Selftest result{selftest::OwnCases()};
  if (FLAGS_nist.empty()) {
    std::printf("NIST's 27 certified regressions are not run; --nist=FOLDER, with their files, adds them\n\n");
  } else {
    const Result<std::vector<SelftestRow>> nist = selftest::NistCases(FLAGS_nist);
    if (!nist.ok()) return Complain(nist.error().message);
    result.rows.insert(result.rows.end(), nist->begin(), nist->end());
  }
  std::printf("%s", ToText(result).c_str());
  return result.ok() ? kTrusted : kUnreliable;
}

}  // namespace

const Command kSelftestCommand = {"selftest",
                                  "",
                                  "the program's arithmetic against known answers: digits reached, pass or fail",
                                  {{"nist"}},
                                  &RunSelftest};

}  // namespace scancal

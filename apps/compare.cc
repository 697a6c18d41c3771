// scancal compare DATASET
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/calibrate.h"
#include "apps/command.h"
#include "report/text.h"

DEFINE_string(surface, "",
              "CSV file to write: the search's objective S over M and N at the declared step (Fig. 6 of the paper)");

namespace scancal {
namespace {

Result<Comparison> Compared(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, LoadAndEcho(arguments));
  if (!FLAGS_surface.empty()) {
    const Result<void> written = scanner->WriteSurface(FLAGS_surface);
    if (!written.ok()) return Error{"--surface: " + written.error().message};
  }
  return scanner->Compare({});
}

int RunCompare(const std::vector<std::string>& arguments) {
  const Result<Comparison> comparison = Compared(arguments);
  if (!comparison.ok()) return Complain(comparison.error().message);
  std::printf("%s", ToText(*comparison).c_str());
  return kTrusted;
}

}  // namespace

const Command kCompareCommand = {"compare",
                                 "DATASET",
                                 "the published grid search and the joint refinements on the same data, one table",
                                 {{"surface"}},
                                 &RunCompare};

}  // namespace scancal

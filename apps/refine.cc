// scancal refine DATASET
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include "apps/command.h"
#include "apps/load.h"
#include "io/json_file.h"
#include "report/calibration_json.h"
#include "report/text.h"

DEFINE_string(out, "", "folder or file to write");
DEFINE_string(residual, "depth",
              "depth (measured depth minus the depth that the model predicts) or plane (plain "
              "point-to-plane, biased)");
DEFINE_string(weights, "estimated",
              "estimated (generalised least squares with the variances that the residuals show) or equal");
DEFINE_int32(max_iterations, 100, "most iterations of the refinement");

namespace scancal {
namespace {

Result<Calibration> Refined(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, LoadAndEcho(arguments));
  SCANCAL_ASSIGN_OR_RETURN(Calibration calibration,
                           scanner->Calibrate({FLAGS_residual, FLAGS_weights == "equal", FLAGS_max_iterations}));
  SCANCAL_ASSIGN_OR_RETURN(calibration.inputs, InputsOf(*scanner));
  calibration.command = CommandLine();
  calibration.version = SCANCAL_VERSION;
  Json json = ToJson(calibration);
  SCANCAL_ASSIGN_OR_RETURN(json["data"], scanner->Data());
  SCANCAL_RETURN_IF_ERROR(WriteJson(std::filesystem::path(FLAGS_out) / "calibration.json", json));
  return calibration;
}

int Run(const std::vector<std::string>& arguments) {
  if (FLAGS_max_iterations < 1) return Complain("--max_iterations: expected 1 or more");
  if (FLAGS_weights != "estimated" && FLAGS_weights != "equal")
    return Complain("--weights: found \"" + FLAGS_weights + "\", expected estimated or equal");
  const Result<Calibration> calibration = Refined(arguments);
  if (!calibration.ok()) return Complain(calibration.error().message);
  std::printf("%s", ToText(*calibration).c_str());
  return calibration->ok() ? kTrusted : kUnreliable;
}

}  // namespace

const Command kRefineCommand = {
    "refine",
    "DATASET",
    "calibrate: search, joint refinement, uncertainty; writes calibration.json, which can stand for DATASET later",
    {{"out", "folder for calibration.json (default: the current one)"}, {"residual"}, {"weights"}, {"max_iterations"}},
    &Run};

}  // namespace scancal

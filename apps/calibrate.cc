#include "apps/calibrate.h"
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include "apps/command.h"
#include "apps/load.h"
#include "io/json_file.h"
#include "io/output_file.h"
#include "report/calibration_json.h"
#include "report/page.h"
#include "report/text.h"

DEFINE_string(out, "", "folder or file to write");
DEFINE_bool(report, false, "write report.html beside calibration.json, as scancal report does");
DECLARE_string(language);

namespace scancal {
namespace {

constexpr int kFewestTrials = 100, kMostTrials = 10'000'000;

Result<Calibration> Calibrated(const std::vector<std::string>& arguments, const RefineChoice& choice) {
  SCANCAL_RETURN_IF_ERROR(CheckLanguage());
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, LoadAndEcho(arguments));
  const std::filesystem::path file = std::filesystem::path(FLAGS_out) / "calibration.json";
  SCANCAL_RETURN_IF_ERROR(OutputFile::Create(file));  // told before the work, not after it
  SCANCAL_ASSIGN_OR_RETURN(Calibration calibration, scanner->Calibrate(choice));
  SCANCAL_ASSIGN_OR_RETURN(calibration.inputs, InputsOf(*scanner));
  calibration.command = CommandLine();
  calibration.version = SCANCAL_VERSION;
  Enclosures with{.certificate = scanner->dataset().certificate};
  SCANCAL_ASSIGN_OR_RETURN(with.data, scanner->Data());
  // What the other methods cannot do is no reason to lose this one's result.
  if (const Result<Comparison> comparison = scanner->Compare({.brief = true}); comparison.ok())
    with.comparison = *comparison;
  SCANCAL_RETURN_IF_ERROR(WriteJson(file, ToJson(calibration, with)));
  return calibration;
}

}  // namespace

int CalibrateAndReport(const std::vector<std::string>& arguments, const RefineChoice& choice) {
  const Result<Calibration> calibration = Calibrated(arguments, choice);
  if (!calibration.ok()) return Complain(calibration.error().message);
  std::printf("%s", ToText(*calibration).c_str());
  if (FLAGS_report) {
    std::fflush(stdout);
    const std::filesystem::path folder = FLAGS_out;
    const Result<bool> written =
        WritePage(folder / "calibration.json", {folder / "report.html", {}, {}, {}, FLAGS_language});
    if (!written.ok()) return Complain(written.error().message);
    if (!*written) return kBadInput;
  }
  return calibration->ok() ? kTrusted : kUnreliable;
}

Result<void> CheckTrials(const std::string& flag, int trials) {
  if (trials >= kFewestTrials && trials <= kMostTrials) return {};
  return Error{"--" + flag + ": found " + std::to_string(trials) + ", expected " + std::to_string(kFewestTrials) +
               " to " + std::to_string(kMostTrials) + " trials"};
}

}  // namespace scancal

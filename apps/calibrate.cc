#include "apps/calibrate.h"
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <future>
#include <optional>
#include "apps/command.h"
#include "io/input_file.h"
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

bool IsResult(const std::filesystem::path& file) { return file.extension() == ".json"; }

bool HasData(const Json& json) {
  return json.contains("data") && json["data"].is_object() && json["data"].contains("dataset") &&
         json["data"]["dataset"].is_string();
}

Result<std::unique_ptr<Scanner>> Reload(const Json& json, const std::string& file) {
  SCANCAL_RETURN_IF_ERROR(CalibrationFromJson(json, file));
  if (!HasData(json))
    return Error{file + ": found no compressed data, which older versions did not keep; refine the data set itself"};
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset,
                           ParseDataset(json["data"]["dataset"], file, file + ": data: dataset"));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->reload(dataset, json["data"], file);
}

Result<std::unique_ptr<Scanner>> Load(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && IsResult(arguments[0])) {
    SCANCAL_ASSIGN_OR_RETURN(const Json json, ReadJson(arguments[0]));
    return Reload(json, arguments[0]);
  }
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->load(dataset);
}

// That a result is what its own data say: every estimate and its u to a millionth of u, and the status.
Result<void> CheckSaysTheSame(const Calibration& found, const Calibration& data, const std::string& file) {
  constexpr double kOfU = 1e-6;
  const auto differs = [&](const std::string& what, const std::string& here, const std::string& there) {
    return Error{file + ": " + what + " is " + here + ", but its own data say " + there +
                 ": edited, or of another version; refine the data set, or this file, again"};
  };
  for (const Parameter& parameter : data.parameters) {
    if (parameter.role != Role::kEstimate) continue;
    const Parameter* const here = found.Find(parameter.name);
    if (!here) return differs(parameter.name, "missing", fmt::format("{:.9g}", parameter.value));
    for (const auto& [name, number] : {std::pair{"", &Parameter::value}, {"u of ", &Parameter::u}})
      if (!(std::abs(here->*number - parameter.*number) <= kOfU * parameter.u))
        return differs(name + parameter.name, fmt::format("{:.9g}", here->*number),
                       fmt::format("{:.9g}", parameter.*number));
  }
  const auto status = [](const Calibration& c) { return c.ok() ? "ok" : "unreliable"; };
  if (found.ok() != data.ok()) return differs("status", status(found), status(data));
  return {};
}

Result<Calibration> Calibrated(const std::vector<std::string>& arguments, RefineChoice choice) {
  SCANCAL_RETURN_IF_ERROR(CheckLanguage());
  const std::filesystem::path folder = FLAGS_out, file = folder / "calibration.json";
  // What cannot be written is told before the work, not after it, and Ctrl-C says that it is missing. A folder of its
  // own is made when there is something to calibrate.
  std::optional<OutputFile> until_written;
  const auto reserve = [&]() -> Result<void> {
    SCANCAL_ASSIGN_OR_RETURN(until_written, OutputFile::Create(file));
    return {};
  };
  const bool is_there = folder.empty() || std::filesystem::is_directory(folder);
  if (is_there) SCANCAL_RETURN_IF_ERROR(reserve());
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, LoadAndEcho(arguments));
  if (!is_there) SCANCAL_RETURN_IF_ERROR(reserve());
  // Reading a file twice takes as long as a fit.
  auto inputs = std::async(std::launch::async, [&] { return InputsOf(*scanner); });
  choice.figures = false;
  SCANCAL_ASSIGN_OR_RETURN(Calibration calibration, scanner->Calibrate(choice));
  SCANCAL_ASSIGN_OR_RETURN(calibration.inputs, inputs.get());
  calibration.command = CommandLine();
  calibration.version = SCANCAL_VERSION;
  Enclosures with{.certificate = scanner->dataset().certificate};
  SCANCAL_ASSIGN_OR_RETURN(with.data, scanner->Data());
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
    const std::filesystem::path folder = FLAGS_out, file = folder / "calibration.json";
    const Result<Json> figures = FiguresOf(file);
    if (!figures.ok()) return Complain(figures.error().message);
    const Result<bool> written = WritePage(file, *figures, {folder / "report.html", {}, {}, {}, FLAGS_language});
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

Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Error{"found " + std::to_string(arguments.size()) + " arguments, expected one: the folder of a data set"};
  if (IsResult(arguments[0]))
    return Error{arguments[0] + ": found a result without scans, expected the folder of a data set"};
  return ReadDataset(arguments[0]);
}

Result<std::unique_ptr<Scanner>> LoadAndEcho(const std::vector<std::string>& arguments) {
  SCANCAL_ASSIGN_OR_RETURN(std::unique_ptr<Scanner> scanner, Load(arguments));
  std::printf("%s\n\n", scanner->Describe().c_str());
  return scanner;
}

Result<Json> FiguresOf(const std::filesystem::path& calibration) {
  const Result<Json> json = ReadJson(calibration);
  if (!json.ok() || !json->is_object() || HoldsFigures(*json)) return Json();
  const Result<Calibration> found = CalibrationFromJson(*json, calibration.string());
  if (!found.ok()) return Json();
  if (!HasData(*json)) {
    std::fprintf(stderr, "scancal: warning: %s: found no compressed data: figures that need them are left out\n",
                 calibration.c_str());
    return Json();
  }
  SCANCAL_ASSIGN_OR_RETURN(const std::unique_ptr<Scanner> scanner, Reload(*json, calibration.string()));
  const RefineChoice choice{.residual = found->residual, .equal_weights = found->equal_weights};
  SCANCAL_ASSIGN_OR_RETURN(const Calibration again, scanner->Calibrate(choice));
  if (again.converged) SCANCAL_RETURN_IF_ERROR(CheckSaysTheSame(*found, again, calibration.string()));
  const Result<Comparison> comparison = scanner->Compare({.brief = true});
  return FiguresToJson(again, comparison.ok() ? *comparison : Comparison{});  // without what others cannot do
}

Result<std::vector<HashedFile>> InputsOf(const Scanner& scanner) {
  std::vector<HashedFile> inputs, before;
  for (const std::filesystem::path& file : scanner.Files()) {
    SCANCAL_ASSIGN_OR_RETURN(const std::string sha256, Sha256(file));
    inputs.push_back({file.filename().string(), sha256});
    if (!IsResult(file)) continue;
    SCANCAL_ASSIGN_OR_RETURN(const Calibration result, ReadCalibration(file));
    before = result.inputs;
  }
  inputs.insert(inputs.end(), before.begin(), before.end());
  return inputs;
}

}  // namespace scancal

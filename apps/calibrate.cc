#include "apps/calibrate.h"
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <cstdio>
#include <filesystem>
#include <future>
#include <optional>
#include "apps/command.h"
#include "apps/done.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/output_file.h"
#include "io/signature.h"
#include "report/calibration_json.h"
#include "report/page.h"
#include "report/text.h"

DEFINE_string(out, "", "folder or file to write");
DEFINE_bool(report, false, "write report.html beside calibration.json, as scancal report does");
DEFINE_bool(accept_unreliable, false, "exit code 0 in place of 2: what was computed is done, for engines that repeat");
DEFINE_bool(wide, false, "every column and table; else, of many quantities, what fits into 100 columns");
DEFINE_bool(resume, false, "nothing to do where --out has the result of the same files and flags; done.json tells");
DECLARE_string(language);
DECLARE_string(sign);

namespace scancal {
namespace {

constexpr int kFewestTrials = 100, kMostTrials = 10'000'000;

bool IsResult(const std::filesystem::path& file) { return file.extension() == ".json"; }

Result<std::unique_ptr<Scanner>> Load(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && IsResult(arguments[0])) {
    SCANCAL_ASSIGN_OR_RETURN(const Json json, ReadJson(arguments[0]));
    return Reload(json, arguments[0]);
  }
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->load(dataset);
}

struct Calibrated {
  Calibration calibration;
  std::vector<std::filesystem::path> read;
};

Result<Calibrated> Calibrate(const std::vector<std::string>& arguments, RefineChoice choice) {
  SCANCAL_RETURN_IF_ERROR(CheckLanguage());
  const std::filesystem::path folder = FLAGS_out, file = folder / "calibration.json";
  std::optional<SigningKey> key;
  if (!FLAGS_sign.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(key, SigningKey::Read(FLAGS_sign));
  }
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
  Enclosures with;
  if (const auto& certificate = scanner->dataset().certificate) with.certificate = *certificate;
  SCANCAL_ASSIGN_OR_RETURN(with.data, scanner->Data());
  SCANCAL_RETURN_IF_ERROR(WriteJson(file, ToJson(calibration, with)));
  if (key) SCANCAL_RETURN_IF_ERROR(key->Sign(file));
  return Calibrated{std::move(calibration), scanner->Files()};
}

int ExitCode(bool ok) { return ok || FLAGS_accept_unreliable ? kTrusted : kUnreliable; }

}  // namespace

int CalibrateAndReport(const std::vector<std::string>& arguments, const RefineChoice& choice) {
  const std::filesystem::path folder = FLAGS_out, file = folder / "calibration.json";
  if (FLAGS_resume && arguments.size() == 1) {
    const Json done = FindDone(folder, arguments[0]);
    if (!done.is_null()) {
      fmt::print("unchanged: {} is of the same files, flags and version; status {}\n", file.string(),
                 done["status"].get<std::string>());
      return ExitCode(done["status"] == "ok");
    }
  }
  const Result<Calibrated> done = Calibrate(arguments, choice);
  if (!done.ok()) return Complain(done.error().message);
  Print(ToText(done->calibration, FLAGS_wide));
  if (FLAGS_report) {
    std::fflush(stdout);
    const Result<Rechecked> again = Recheck(file, /*monte_carlo=*/false);  // it was drawn a moment ago
    if (!again.ok()) return Complain(again.error().message);
    const Result<bool> written =
        WritePage(file, FiguresOf(*again), {folder / "report.html", {}, {}, {}, FLAGS_language});
    if (!written.ok()) return Complain(written.error().message);
    if (!*written) return kBadInput;
  }
  if (FLAGS_resume) {
    const Result<void> kept = WriteDone(folder, arguments[0], done->read, done->calibration);
    if (!kept.ok()) return Complain(kept.error().message);
  }
  return ExitCode(done->calibration.ok());
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
  std::printf("%s\n", scanner->Describe().c_str());
  return scanner;
}

Json FiguresOf(const Rechecked& result) {
  Json figures = Json::object();
  if (result.again) {
    const Result<Comparison> comparison = result.scanner->Compare({.brief = true});
    figures = FiguresToJson(*result.again, comparison.ok() ? *comparison : Comparison{});  // without what others cannot
  } else {
    figures["messages"] = Json::array();
  }
  if (result.doubts.empty()) return figures;
  figures["warnings"] = result.file.contains("warnings") ? result.file["warnings"] : Json::array();
  for (const Sentence& doubt : result.doubts) {
    figures["warnings"].push_back(doubt.english);
    figures["messages"].push_back(ToJson(doubt));
  }
  return figures;
}

Result<std::vector<HashedFile>> InputsOf(const Scanner& scanner) {
  std::vector<HashedFile> inputs, before;
  for (const std::filesystem::path& file : scanner.Files()) {
    std::error_code ignored;
    if (std::filesystem::is_fifo(file, ignored)) {  // gone when it has been read
      inputs.push_back({file.filename().string(), ""});
      continue;
    }
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

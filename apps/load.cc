#include "apps/load.h"
#include <cstdio>
#include "io/input_file.h"
#include "io/json_file.h"
#include "report/calibration_json.h"

namespace scancal {
namespace {

bool IsResult(const std::filesystem::path& file) { return file.extension() == ".json"; }

Result<std::unique_ptr<Scanner>> Reload(const std::string& file) {
  SCANCAL_ASSIGN_OR_RETURN(const Json json, ReadJson(file));
  SCANCAL_RETURN_IF_ERROR(CalibrationFromJson(json, file));
  const bool has_data = json.contains("data") && json["data"].is_object() && json["data"].contains("dataset") &&
                        json["data"]["dataset"].is_string();
  if (!has_data)
    return Error{file + ": found no compressed data, which older versions did not keep; refine the data set itself"};
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset,
                           ParseDataset(json["data"]["dataset"], file, file + ": data: dataset"));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->reload(dataset, json["data"], file);
}

Result<std::unique_ptr<Scanner>> Load(const std::vector<std::string>& arguments) {
  if (arguments.size() == 1 && IsResult(arguments[0])) return Reload(arguments[0]);
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset, ReadOnlyArgument(arguments));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->load(dataset);
}

}  // namespace

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

// scancal recheck CALIBRATION, and the check that other commands make.
#include "apps/recheck.h"
#include <fmt/format.h>
#include <gflags/gflags.h>
#include <cstdio>
#include "apps/command.h"
#include "io/input_file.h"
#include "io/json_file.h"
#include "io/signature.h"
#include "models/models.h"
#include "report/calibration_json.h"

DEFINE_string(key, "", "public key in PEM: the calibration.json is refused unless FILE.sig is its signature");
DEFINE_string(sign, "", "private key in PEM (Ed25519): signs calibration.json, in calibration.json.sig");
DEFINE_bool(unreliable, false, "measure with a calibration of status unreliable all the same");

namespace scancal {
namespace {

constexpr Message<> kNoData{
    "apps.no_data",
    "the file holds no compressed data: nobody can say that its numbers are what was measured; refine the data set "
    "again",
    "Die Datei enthält keine verdichteten Daten: Ob ihre Zahlen das Gemessene wiedergeben, kann niemand sagen; der "
    "Datensatz ist neu auszuwerten"};
constexpr Message<std::string, std::string, std::string, std::string, std::string> kOtherVersion{
    "apps.other_version",
    "scancal {} wrote this file; scancal {} computes otherwise of the same data: {} is {} in the file, {} computed "
    "again; "
    "refine it again, or ask who changed it",
    "scancal {} hat diese Datei geschrieben; scancal {} berechnet aus denselben Daten anderes: {} ist in der Datei {}, "
    "neu berechnet {}; neu auswerten, oder fragen, wer sie geändert hat"};

std::string VersionOf(const Json& json) {
  return json.contains("version") && json["version"].is_string() ? json["version"].get<std::string>() : "of old";
}

Error NotWhatItsDataSay(const std::string& file, const Difference& difference) {
  return {file + ": " + difference.where + " is " + difference.here + ", but its own data say " + difference.there +
          ": the file was edited, or another build of this version made it; refine the data set, or this file, again"};
}

// dataset.yaml is an input like the others; its text is in the file, its fingerprint too.
std::optional<Difference> OfDeclaration(const Json& json, const Calibration& found) {
  if (found.inputs.empty() || std::filesystem::path(found.inputs[0].file).extension() == ".json") return {};
  const Result<std::string> sha256 = Sha256OfText(json["data"]["dataset"].get_ref<const std::string&>());
  if (!sha256.ok() || *sha256 == found.inputs[0].sha256) return {};
  return Difference{"SHA-256 of " + found.inputs[0].file, found.inputs[0].sha256, *sha256};
}

Result<void> CheckSignature(const std::filesystem::path& file) {
  if (FLAGS_key.empty()) return {};
  SCANCAL_ASSIGN_OR_RETURN(const SigningKey key, SigningKey::ReadPublic(FLAGS_key));
  return key.Verify(file);
}

// What both say under this key is the same; what only one says cannot contradict.
Result<void> CheckKey(const char* key, const Json& calibrated, const Json& used, const std::string& place) {
  if (calibrated.is_null() || used.is_null() || calibrated == used) return {};
  return Error{place + key + " is " + used.dump() + ", but the calibration is of " + calibrated.dump() +
               "; expected the data of the instrument that was calibrated, declared alike"};
}

Json ItemOf(const Dataset& dataset) {
  const Json* certificate = dataset.certificate.get();
  return certificate && certificate->is_object() && certificate->contains("item") ? certificate->at("item") : Json();
}

Json ValueOf(const Json& object, const char* key) {
  return object.is_object() && object.contains(key) ? object[key] : Json();
}

// Serial numbers count under the same issuer.
Result<void> CheckSameItem(const Json& calibrated, const Json& used, const std::string& place) {
  for (const char* key : {"manufacturer", "model"})
    SCANCAL_RETURN_IF_ERROR(CheckKey(key, ValueOf(calibrated, key), ValueOf(used, key), place));
  for (const Json& there : ValueOf(calibrated, "identifications"))
    for (const Json& here : ValueOf(used, "identifications"))
      if (ValueOf(there, "issuer") == ValueOf(here, "issuer"))
        SCANCAL_RETURN_IF_ERROR(CheckKey("identification", ValueOf(there, "value"), ValueOf(here, "value"), place));
  return {};
}

Result<int> SayWhetherItHolds(const std::filesystem::path& file) {
  SCANCAL_ASSIGN_OR_RETURN(const Rechecked result, Recheck(file, /*monte_carlo=*/true));
  for (const Sentence& doubt : result.doubts) return Error{file.string() + ": " + doubt.english};
  if (!FLAGS_sign.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(const SigningKey key, SigningKey::Read(FLAGS_sign));
    SCANCAL_RETURN_IF_ERROR(key.Sign(file));
  }
  fmt::print("{}: {} numbers are what its own data say, to {:.1g} u; status {}{}\n", file.string(),
             result.agreement.numbers, result.agreement.largest_in_u, result.found.ok() ? "ok" : "unreliable",
             !FLAGS_sign.empty()  ? "; signed with " + FLAGS_sign
             : !FLAGS_key.empty() ? "; signed by the key of " + FLAGS_key
                                  : "");
  return result.found.ok() ? kTrusted : kUnreliable;
}

int RunRecheck(const std::vector<std::string>& arguments) {
  if (arguments.size() != 1)
    return Complain("found " + std::to_string(arguments.size()) + " arguments, expected one: a calibration.json");
  const Result<int> code = SayWhetherItHolds(CalibrationIn(arguments[0]));
  return code.ok() ? *code : Complain(code.error().message);
}

}  // namespace

std::filesystem::path CalibrationIn(const std::filesystem::path& given) {
  return std::filesystem::is_directory(given) ? given / "calibration.json" : given;
}

bool HoldsData(const Json& json) {
  return json.contains("data") && json["data"].is_object() && json["data"].contains("dataset") &&
         json["data"]["dataset"].is_string();
}

Result<std::unique_ptr<Scanner>> Reload(const Json& json, const std::string& file) {
  SCANCAL_RETURN_IF_ERROR(CalibrationFromJson(json, file));
  if (!HoldsData(json))
    return Error{file + ": found no compressed data, which older versions did not keep; refine the data set itself"};
  SCANCAL_ASSIGN_OR_RETURN(const Dataset dataset,
                           ParseDataset(json["data"]["dataset"], file, file + ": data: dataset"));
  SCANCAL_ASSIGN_OR_RETURN(const ScannerKind* kind, FindScannerKind(dataset));
  return kind->reload(dataset, json["data"], file);
}

Result<Rechecked> Recheck(const std::filesystem::path& file, bool monte_carlo) {
  SCANCAL_RETURN_IF_ERROR(CheckSignature(file));
  Rechecked result;
  SCANCAL_ASSIGN_OR_RETURN(result.file, ReadJson(file));
  SCANCAL_ASSIGN_OR_RETURN(result.found, CalibrationFromJson(result.file, file.string()));
  if (!HoldsData(result.file)) {
    result.doubts = {Say(kNoData)};
    return result;
  }
  const bool same_version = VersionOf(result.file) == SCANCAL_VERSION;
  const auto differs = [&](const Difference& difference) -> Result<void> {
    if (same_version) return NotWhatItsDataSay(file.string(), difference);
    result.doubts = {Say(kOtherVersion, VersionOf(result.file), SCANCAL_VERSION, difference.where, difference.here,
                         difference.there)};
    return {};
  };
  if (const auto declared = OfDeclaration(result.file, result.found)) SCANCAL_RETURN_IF_ERROR(differs(*declared));
  SCANCAL_ASSIGN_OR_RETURN(result.scanner, Reload(result.file, file.string()));
  RefineChoice choice{.residual = result.found.residual, .equal_weights = result.found.equal_weights};
  const MonteCarloSummary& drawn = result.found.monte_carlo;
  if (monte_carlo && drawn.trials > 0)
    choice.monte_carlo = {static_cast<int64_t>(drawn.trials), drawn.seed, drawn.digits};
  Result<Calibration> again = result.scanner->Calibrate(choice);
  if (!again.ok()) {
    SCANCAL_RETURN_IF_ERROR(differs({"the result", "there", "that there is none (" + again.error().message + ")"}));
    return result;
  }
  result.again = *std::move(again);
  RecheckChoice keys;
  keys.same_keys = same_version;
  if (!monte_carlo) keys.without.insert({"montecarlo", "warnings"});
  Enclosures with;
  if (const auto& certificate = result.scanner->dataset().certificate) with.certificate = *certificate;
  result.agreement = CompareResults(result.file, ToJson(*result.again, with), keys);
  if (result.agreement.first) SCANCAL_RETURN_IF_ERROR(differs(*result.agreement.first));
  return result;
}

Result<Rechecked> RecheckForUse(const std::filesystem::path& file) {
  SCANCAL_ASSIGN_OR_RETURN(Rechecked result, Recheck(file, /*monte_carlo=*/false));
  if (result.found.ok() || FLAGS_unreliable) return result;
  return Error{file.string() + ": its status is unreliable, expected ok; refine better data, or add --unreliable to " +
               "measure with it all the same"};
}

int WarnOf(const Rechecked& result, const std::filesystem::path& file) {
  for (const Sentence& doubt : result.doubts)
    std::fprintf(stderr, "scancal: warning: %s: %s\n", file.c_str(), doubt.english.c_str());
  if (!result.found.ok()) std::fprintf(stderr, "scancal: warning: %s has status unreliable\n", file.c_str());
  return result.found.ok() && result.doubts.empty() ? kTrusted : kUnreliable;
}

Result<void> CheckSameInstrument(const Rechecked& calibration, const Dataset& dataset) {
  if (calibration.found.model != dataset.model)
    return Error{"the calibration is of model \"" + calibration.found.model + "\", the data set of \"" + dataset.model +
                 "\""};
  if (!calibration.scanner) return {};
  const Dataset& calibrated = calibration.scanner->dataset();
  const std::string place = dataset.file.string() + ": ";
  const auto units = [](const Dataset& of) { return Json{{"length", of.units.length}, {"angle", of.units.angle}}; };
  SCANCAL_RETURN_IF_ERROR(CheckKey("units", units(calibrated), units(dataset), place));
  // Read anew: a key that is asked for counts as known.
  SCANCAL_ASSIGN_OR_RETURN(Dataset here, ParseDataset(dataset.text, dataset.file, place));
  SCANCAL_ASSIGN_OR_RETURN(Dataset there, ParseDataset(calibrated.text, calibrated.file, place));
  for (const char* key : {"rotation", "depth", "robot"})
    SCANCAL_RETURN_IF_ERROR(CheckKey(key, there.yaml.Json(key), here.yaml.Json(key), place));
  return CheckSameItem(ItemOf(calibrated), ItemOf(dataset), place + "certificate: item: ");
}

const Command kRecheckCommand = {"recheck",
                                 "FILE.json",
                                 "whether a calibration.json is what its own data say, computed again",
                                 {{"key"}, {"sign"}},
                                 &RunRecheck};

}  // namespace scancal

// The features of a verify.yaml; docs/data.md, section 9.
#include <algorithm>
#include <string>
#include <vector>
#include "io/message.h"
#include "models/scanner.h"
#include "models/turntable/planes_file.h"
#include "models/turntable/verify.h"

namespace scancal::turntable {
namespace {

struct DeclaredFeature {
  Feature feature;
  std::vector<std::string> of;  // names of targets
  std::string place;            // where they stand
};

// What is wrong is reported by Finish().
DeclaredFeature ReadFeature(YamlMap map, const Units& units) {
  DeclaredFeature result;
  Feature& feature = result.feature;
  feature.name = map.Text("name");
  feature.at = map.Text("at", "");
  feature.nominal = map.Number("nominal") * units.length_in_mm;
  feature.u = map.Number("U") / 2 * units.length_in_mm;  // k = 2
  if (feature.nominal <= 0) map.Fail("nominal", "expected the value on the certificate, more than 0");
  if (feature.u < 0) map.Fail("U", "expected its expanded uncertainty (k = 2), not below 0");
  int kinds = 0;
  for (const Feature::Kind kind : {Feature::Kind::kDiameter, Feature::Kind::kDistance, Feature::Kind::kStep}) {
    const char* key = Name(kind);
    if (!map.Has(key)) continue;
    ++kinds;
    feature.kind = kind;
    const size_t expected = kind == Feature::Kind::kDiameter ? 1 : 2;
    result.of = expected == 1 ? std::vector{map.Text(key)} : map.Texts(key);
    result.place = map.Where(key);
    if (result.of.size() != expected || (expected == 2 && result.of[0] == result.of[1]))
      map.Fail(key, "expected the names of two targets");
  }
  if (kinds != 1) map.Fail("", "expected one of diameter: TARGET, distance: [TARGET, TARGET], step: [TARGET, TARGET]");
  if (map.Has("tolerance") && map.IsNumber("tolerance")) {
    const double limit = map.Number("tolerance") * units.length_in_mm;
    if (!(limit > 0)) map.Fail("tolerance", "expected more than 0, or [lower, upper] of the deviation");
    feature.tolerance = {-limit, limit};
  } else if (map.Has("tolerance")) {
    feature.tolerance = map.Interval("tolerance");
    for (double& limit : *feature.tolerance) limit *= units.length_in_mm;
  }
  return result;
}

Result<Feature> Resolved(const DeclaredFeature& declared, const std::vector<SeenTarget>& targets) {
  Feature feature = declared.feature;
  std::vector<std::string> known;
  for (const SeenTarget& each : targets) known.push_back(each.name);
  for (const std::string& name : declared.of) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      return Error{declared.place + ": found " + Quoted(name) + ", no target of this name" + Suggestion(name, known)};
    feature.of.push_back(static_cast<size_t>(found - known.begin()));
  }
  return feature;
}

}  // namespace

Result<Verification> Verify(const Dataset& dataset, const Calibration& calibration) {
  YamlMap top = dataset.yaml;
  std::vector<DeclaredFeature> declared;
  for (const YamlMap& map : top.Maps("features")) declared.push_back(ReadFeature(map, dataset.units));
  if (declared.empty()) top.Fail("features", "expected at least one");
  Model model(Model::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(Declaration declaration, Declare(dataset, &model, /*searches=*/false));
  SCANCAL_RETURN_IF_ERROR(ChoosePlanes(&declaration));
  std::vector<SeenTarget> targets;
  for (const ScanDeclaration& scan : declaration.scans) targets.push_back({scan.name, scan.format.path.string(), {}});
  std::vector<Feature> features;
  for (const DeclaredFeature& each : declared) {
    SCANCAL_ASSIGN_OR_RETURN(Feature feature, Resolved(each, targets));
    features.push_back(std::move(feature));
  }
  for (size_t t = 0; t < targets.size(); ++t) {
    SCANCAL_ASSIGN_OR_RETURN(targets[t].points, ReadKept(declaration.scans[t], declaration.senses));
  }
  return VerifyFeatures(calibration, targets, features);
}

}  // namespace scancal::turntable

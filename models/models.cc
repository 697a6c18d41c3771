#include "models/models.h"
#include "models/flange_ball/scanner.h"
#include "models/robot_ball/scanner.h"
#include "models/robot_profiler/scanner.h"
#include "models/turntable/scanner.h"

namespace scancal {
namespace {

constexpr ScannerKind kKinds[] = {turntable::kKind, robot_ball::kKind, robot_ball::kTrackerKind, flange_ball::kKind,
                                  robot_profiler::kKind};

}  // namespace

Result<const ScannerKind*> FindScannerKind(const Dataset& dataset) {
  return FindScannerKind(dataset.model, dataset.yaml.Where("model"));
}

Result<const ScannerKind*> FindScannerKind(const std::string& name, const std::string& place) {
  std::string names;
  for (const ScannerKind& kind : kKinds) {
    if (name == kind.name) return &kind;
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  return Error{place + ": found \"" + name + "\", expected one of: " + names};
}

const std::set<std::string>& AnewInEachCalibration() {
  static const std::set<std::string> names = {"expansion", "drift", "drift_sweep", "drift_temperature", "warm_up"};
  return names;
}

}  // namespace scancal

#include "models/models.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {
namespace {

constexpr ScannerKind kKinds[] = {kTurntable};

}  // namespace

Result<const ScannerKind*> FindScannerKind(const Dataset& dataset) {
  std::string names;
  for (const ScannerKind& kind : kKinds) {
    if (dataset.model == kind.name) return &kind;
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  return Error{dataset.yaml.Where("model") + ": found \"" + dataset.model + "\", expected one of: " + names};
}

}  // namespace scancal

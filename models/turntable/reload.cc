// A turntable that was calibrated before, from its compressed data instead of the scans.
#include "models/turntable/compressed_data.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {

Result<Json> TurntableScanner::Data() const {
  Json data = {{"dataset", declaration_.dataset.text}};
  SCANCAL_ASSIGN_OR_RETURN(const Json placements, PlacementsToJson(placements_));
  data.update(placements);
  return data;
}

Result<std::unique_ptr<Scanner>> ReloadTurntable(const Dataset& dataset, const Json& data, const std::string& file) {
  Turntable model(Turntable::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(TurntableDeclaration declaration, DeclareTurntable(dataset, &model));
  SCANCAL_ASSIGN_OR_RETURN(std::vector<Placement> placements, PlacementsFromJson(data, file));
  const bool as_declared =
      std::equal(placements.begin(), placements.end(), declaration.scans.begin(), declaration.scans.end(),
                 [](const Placement& placement, const ScanDeclaration& scan) { return placement.name == scan.name; });
  if (!as_declared) return Error{file + ": data: expected the targets that data: dataset declares, in their order"};
  for (const Placement& placement : placements)
    if (!placement.warning.empty()) declaration.warnings.push_back(placement.warning);
  declaration.scans.clear();  // nothing is left to be read
  SCANCAL_RETURN_IF_ERROR(CheckPlausible(placements, dataset.units));
  return std::unique_ptr<Scanner>(
      std::make_unique<TurntableScanner>(std::move(declaration), std::move(model), std::move(placements)));
}

}  // namespace scancal

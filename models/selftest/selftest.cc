#include "models/selftest/selftest.h"
#include "io/message.h"
#include "models/selftest/exact_shapes.h"
#include "models/selftest/gum.h"
#include "models/selftest/nist.h"

namespace scancal {

std::vector<SelftestRow> OwnCases() {
  std::vector<SelftestRow> rows = {CheckGaugeBlock(), CheckImpedance(), CheckThermometer()};
  for (const ExactShape& shape : ExactShapes()) rows.push_back(Check(shape));
  return rows;
}

Result<std::vector<SelftestRow>> NistCases(const std::filesystem::path& folder) {
  std::vector<std::string> missing;
  for (const NistModel& model : NistModels())
    if (!std::filesystem::exists(folder / (std::string(model.name) + ".dat"))) missing.emplace_back(model.name);
  if (!missing.empty())
    return Error{folder.string() + ": found " + std::to_string(NistModels().size() - missing.size()) +
                 " of the 27 files of NIST's nonlinear regressions (www.itl.nist.gov/div898/strd), expected all; "
                 "missing .dat files: " +
                 Listed(missing)};
  std::vector<SelftestRow> rows;
  for (const NistModel& model : NistModels()) {
    SCANCAL_ASSIGN_OR_RETURN(const NistData data, ReadNist(folder / (std::string(model.name) + ".dat"), model));
    rows.push_back(Check(model, data));
  }
  return rows;
}

}  // namespace scancal

// The list of models.
#pragma once
#include <set>
#include <string>
#include "models/scanner.h"

namespace scancal {

// The kind that dataset.yaml names, or an error that lists what there is.
Result<const ScannerKind*> FindScannerKind(const Dataset& dataset);
// The same by name; place: where it was found, for the message.
Result<const ScannerKind*> FindScannerKind(const std::string& name, const std::string& place);

// What is considered under these names is another error in each calibration: temperature, drift. Everything else that
// is considered of the system belongs to the instrument or its artifact (SeriesOf).
const std::set<std::string>& AnewInEachCalibration();

}  // namespace scancal

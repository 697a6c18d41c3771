// The list of models.
#pragma once
#include "models/scanner.h"

namespace scancal {

// The kind that dataset.yaml names, or an error that lists what there is.
Result<const ScannerKind*> FindScannerKind(const Dataset& dataset);
// The same by name; place: where it was found, for the message.
Result<const ScannerKind*> FindScannerKind(const std::string& name, const std::string& place);

}  // namespace scancal

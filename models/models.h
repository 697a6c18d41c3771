// The list of models.
#pragma once
#include "models/scanner.h"

namespace scancal {

// The kind that dataset.yaml names, or an error that lists what there is.
Result<const ScannerKind*> FindScannerKind(const Dataset& dataset);

}  // namespace scancal

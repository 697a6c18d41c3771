// The first half of every command on a data set.
#pragma once
#include <memory>
#include <string>
#include <vector>
#include "models/models.h"

namespace scancal {

// Takes the one argument DATASET, reads and compresses it, and echoes what was declared. A calibration.json in its
// place holds the compressed data.
Result<std::unique_ptr<Scanner>> LoadAndEcho(const std::vector<std::string>& arguments);
// What was read with its hashes; behind a calibration.json what it was made from, as it says.
Result<std::vector<HashedFile>> InputsOf(const Scanner& scanner);
Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments);

}  // namespace scancal

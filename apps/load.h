// The first half of every command on a data set.
#pragma once
#include <memory>
#include <string>
#include <vector>
#include "models/models.h"

namespace scancal {

// Takes the one argument DATASET, reads and compresses it, and echoes what was declared.
Result<std::unique_ptr<Scanner>> LoadAndEcho(const std::vector<std::string>& arguments);
Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments);

}  // namespace scancal

// done.json beside a result: the result in short, and what it was made of. The same run again has nothing to do.
#pragma once
#include <filesystem>
#include <string>
#include <vector>
#include "io/json_file.h"
#include "io/result.h"
#include "solver/calibration.h"

namespace scancal {

inline constexpr const char kDoneFile[] = "done.json";

// Flags of refine that say where and how it runs, not what is computed.
bool ChangesResult(const std::string& flag);

// Once everything is written into `folder`. dataset: as it was given; read: every file of calibration.inputs, in its
// order.
Result<void> WriteDone(const std::filesystem::path& folder, const std::string& dataset,
                       const std::vector<std::filesystem::path>& read, const Calibration& calibration);

// done.json of `folder`, if this data set, these flags and this version made it, and every file that was read or
// written then has the same SHA-256 now. null: there is something to do.
Json FindDone(const std::filesystem::path& folder, const std::string& dataset);

}  // namespace scancal

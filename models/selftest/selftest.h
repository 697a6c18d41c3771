// All cases with known answers.
#pragma once
#include <filesystem>
#include <vector>
#include "io/result.h"
#include "solver/results.h"

namespace scancal {

std::vector<SelftestRow> OwnCases();  // the GUM's examples, planes and spheres: no file is needed

// NIST's 27 certified regressions; the folder holds their files, Bennett5.dat and so on.
Result<std::vector<SelftestRow>> NistCases(const std::filesystem::path& folder);

}  // namespace scancal

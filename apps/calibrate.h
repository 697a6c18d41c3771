// What the commands on a data set share: loading it, and calibrating.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
#include "apps/recheck.h"
#include "models/models.h"
#include "models/scanner.h"

namespace scancal {

// Calibrates the one argument DATASET, writes calibration.json below --out, prints the result; returns the exit code.
int CalibrateAndReport(const std::vector<std::string>& arguments, const RefineChoice& choice);

// That a flag of this name asks for a sensible number of trials.
Result<void> CheckTrials(const std::string& flag, int trials);

// Takes the one argument DATASET, reads and compresses it, and echoes what was declared. A calibration.json in its
// place holds the compressed data.
Result<std::unique_ptr<Scanner>> LoadAndEcho(const std::vector<std::string>& arguments);
// What was read with its hashes; behind a calibration.json what it was made from, as it says.
Result<std::vector<HashedFile>> InputsOf(const Scanner& scanner);
// What the page needs besides a calibration.json: the tables of its figures (FiguresToJson), from its compressed data,
// and the doubts about the file among its warnings.
Json FiguresOf(const Rechecked& result);
Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments);

}  // namespace scancal

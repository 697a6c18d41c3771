// What the commands on a data set share: loading it, and calibrating.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>
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
// What a calibration.json leaves out and its page draws (FiguresToJson), from its compressed data. Null of a file that
// holds it, as those of older versions do, or that is none: the page says why.
Result<Json> FiguresOf(const std::filesystem::path& calibration);
Result<Dataset> ReadOnlyArgument(const std::vector<std::string>& arguments);

}  // namespace scancal

// What every command asks of a calibration.json before it relies on it.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>
#include "io/dataset.h"
#include "models/scanner.h"
#include "report/recheck.h"

namespace scancal {

// A result, and what was computed again of its own data.
struct Rechecked {
  Json file;
  Calibration found;                 // as the file says
  std::unique_ptr<Scanner> scanner;  // of the data in it; none: it holds none
  std::optional<Calibration> again;  // with the tables of figures
  Agreement agreement;
  std::vector<Sentence> doubts;  // why nobody can say that it is what its data say; none: it is
};

// The file itself, or calibration.json in that folder.
std::filesystem::path CalibrationIn(const std::filesystem::path& given);

bool HoldsData(const Json& json);
// The scanner of the data in a calibration.json.
Result<std::unique_ptr<Scanner>> Reload(const Json& json, const std::string& file);

// Computes the result again and compares all of it (CompareResults), with its Monte Carlo if asked to. An Error: it is
// no result, or this version wrote it and it is not what its data say, with the first number that differs; or --key is
// given and does not fit its signature. What another version wrote, or what holds no data, is no Error but a doubt.
Result<Rechecked> Recheck(const std::filesystem::path& file, bool monte_carlo);

// For a command that measures with it: one that is unreliable is an Error without --unreliable.
Result<Rechecked> RecheckForUse(const std::filesystem::path& file);
// After the work: warns of doubts and of the status; returns the exit code.
int WarnOf(const Rechecked& result, const std::filesystem::path& file);

// That a data set is of the instrument that was calibrated, as far as both declare it.
Result<void> CheckSameInstrument(const Rechecked& calibration, const Dataset& dataset);

}  // namespace scancal

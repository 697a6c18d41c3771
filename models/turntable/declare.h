// What a turntable's dataset.yaml declares.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/scan.h"
#include "models/turntable.h"
#include "solver/grid_search.h"
#include "solver/sentence.h"

namespace scancal::turntable {

struct KeepInterval {
  std::string column;
  double lower = 0, upper = 0;  // mm, rad; of an unknown column as in the file
  bool operator==(const KeepInterval&) const = default;
};

// Points of a scan that are one plane, as a file of planes tells them: running numbers, from 1, among the points that
// are read from the scan (missing ones do not count). Together with what tells that the scan is the one that they are
// of.
struct PlaneChoice {
  std::string place;                         // "planes.yaml: planes of room: plane 1", for messages
  std::vector<std::array<int64_t, 2>> runs;  // first, last; ascending
  int64_t points_in_file = 0;
  std::string checksum;  // PointsChecksum
};

struct ScanDeclaration {  // one target: one placement of the plate
  std::string name;
  std::string scan;  // as written
  ScanFormat format;
  std::vector<KeepInterval> keep;
  std::string planes;                        // "find", or a file of planes as written; empty: the target is one plane
  std::string planes_place;                  // where that stands
  std::shared_ptr<const PlaneChoice> plane;  // one of that file: see ChoosePlanes
};

// A scan of which nothing is declared but the units: the columns that a turntable knows.
ScanFormat ScanFormatOf(const std::filesystem::path& path, const Units& units);
// What a data set, or a target of its own, says of its files. folder: where paths count from.
void ReadScanFormat(const YamlMap& map, const std::filesystem::path& folder, ScanFormat* format);

struct Senses {
  double angle = 1;  // alpha = angle * reading: clockwise seen from +Z is positive
  double depth = 1;  // y = depth * reading: growing away from the sensor
  bool depth_declared = false;
};

struct Declaration {
  Dataset dataset;
  Senses senses;
  GridBox search;        // of M and N, mm
  bool searches = true;  // false: `search` is not declared, for M and N are known or nothing is calibrated
  std::vector<ScanDeclaration> scans;
  std::optional<double> line_correlation;  // points; declared
  bool drift_declared = false;             // `drift`, whatever it is
  bool drift_held = false;                 // drift_sweep was declared as held, even where sweeps tell it
  std::vector<Sentence> warnings;          // worth knowing
  std::vector<Sentence> notes;             // what was supposed where nothing was declared
};

// Takes every key of the data set; role, value and u of `model`'s quantities are set from parameters and influences. An
// Error names the key and what was expected. searches: M and N are looked for, unless they are known.
Result<Declaration> Declare(const Dataset& dataset, Model* model, bool searches = true);

}  // namespace scancal::turntable

// A scan file as profiles of points in memory: the last place where single points exist.
#pragma once
#include <string>
#include <vector>
#include "io/result.h"
#include "models/turntable/declare.h"

namespace scancal::turntable {

struct RawProfile {
  double key = 0;             // value of the column `profile`; without it the running number
  double alpha = 0;           // rad, clockwise seen from +Z
  std::vector<double> y, z;   // mm
  std::vector<double> range;  // mm; a lidar's, else empty
};

void OrderAlongLine(RawProfile* profile);  // by z; points at one z keep their order

struct RawScan {
  std::string name;                  // of the target
  std::vector<RawProfile> profiles;  // in the order of their keys
  double missing = 0;                // no return
  double off_line = 0;               // removed by Clean: off the line of their profile
  Sentence warning;                  // empty: none
};

// Reads the points that `keep` keeps. With a column `profile` its values group the points, in any order; without it a
// change of the angle starts a profile.
Result<RawScan> ReadScan(const ScanDeclaration& scan, double sense);

// One batch of a scan as points of the sensor: columns angle (rad, by the sense), y, z, and range for a lidar.
struct SensorColumns {
  std::vector<double> alpha, y, z, range;
};
SensorColumns ToSensor(double sense, const ScanBatch& batch);

}  // namespace scancal::turntable

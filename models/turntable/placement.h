// One placement of the plate: its profiles, compressed. The points are gone behind this line.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/turntable.h"
#include "models/turntable/declaration.h"
#include "models/turntable/raw_profiles.h"
#include "solver/calibrate.h"

namespace scancal {

struct Profile {
  double alpha = 0;  // rad, clockwise seen from +Z
  double count = 0;
  ProfileFactor factor;                 // of rows (1, z, y)
  std::optional<ProfileFactor> ranged;  // a lidar's: the same rows times the range at the profile's own line
  PureError pure_error;                 // of depth (of range) about the profile's own line
};

struct Placement {
  std::string name;
  std::vector<Profile> profiles;
  double missing = 0;                       // no return
  std::map<std::string, double> set_aside;  // reason -> points
  double largest = 0;                       // |coordinate|, mm, over all kept points
  double Points() const;
  double Sweep() const;  // largest minus smallest angle, rad
  bool IsLidar() const { return !profiles.empty() && profiles.front().ranged.has_value(); }
};

// Removes what is off each profile's own line.
void Clean(RawScan* scan);

// Reads, keeps, groups into profiles, and cleans. Shows progress.
Result<RawScan> ReadCleanScan(const ScanDeclaration& scan, double sense);

// Sets aside what is off the plane of most profiles, as it appears at `pose`, and compresses the rest.
Placement CompressPlacement(const RawScan& scan, const TurntablePose& pose);

// The profiles as the model sees them.
std::vector<Turntable::View> Views(const std::vector<Profile>& profiles, Turntable::Residuals residuals);

// What of errors that run along a profile moves its line, without their share in what no line explains: that is noise,
// and large. A profiler's line explains all that is affine in z; a lidar's what is linear in (y, z).
Eigen::MatrixXd WithoutPureError(const Turntable::View& view, const Eigen::MatrixXd& columns);

// Units and angles that cannot be: "angles span 30 rad ...; are they degrees?"
Result<void> CheckPlausible(const std::vector<Placement>& placements, const Units& units);

// Compresses one profile's points; range: a lidar's, empty for a profiler.
Profile CompressProfile(double alpha, std::span<const double> y, std::span<const double> z,
                        std::span<const double> range);

}  // namespace scancal

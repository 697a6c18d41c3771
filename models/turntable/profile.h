// One profile, compressed: what its points leave behind.
#pragma once
#include <optional>
#include <span>
#include <vector>
#include "models/turntable.h"
#include "solver/calibrate.h"

namespace scancal {

inline constexpr int kSegments = 8;

struct Profile {
  double alpha = 0;  // rad, clockwise seen from +Z
  double count = 0;
  // Of rows (1, z, y), for each eighth of the profile's extent in z that has points: where a smooth form of the plate
  // bends a profile, its mean is not enough.
  std::vector<ProfileFactor> segments;
  ProfileFactor factor;                 // of all points: the segments, merged
  std::optional<ProfileFactor> ranged;  // a lidar's: the same rows times the range at the profile's own line
  PureError pure_error;                 // of depth (of range) about the profile's own line
};

// From what is kept to what follows from it: factor and pure error.
Profile MakeProfile(double alpha, double count, std::vector<ProfileFactor> segments,
                    const std::optional<ProfileFactor>& ranged);

// Compresses one profile's points, in any order; fastest in that of z. range: a lidar's, empty for a profiler.
Profile CompressProfile(double alpha, std::span<const double> y, std::span<const double> z,
                        std::span<const double> range);

// Of points of the profile, from its own least-squares line: along depth (a lidar's along the range), mm.
std::vector<double> ResidualsFromLine(const Profile& profile, std::span<const double> y, std::span<const double> z);

// The profiles as the model sees them.
std::vector<Turntable::View> Views(const std::vector<Profile>& profiles, Turntable::Residuals residuals);

// What of errors that run along a profile moves its line, without their share in what no line explains: that is noise,
// and large. A profiler's line explains all that is affine in z; a lidar's what is linear in (y, z).
Eigen::MatrixXd WithoutPureError(const Turntable::View& view, const Eigen::MatrixXd& columns);

}  // namespace scancal

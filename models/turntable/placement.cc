// A placement: what is off the lines of its profiles or off its plane is set aside, the rest compressed.
#include <fmt/format.h>
#include <glog/logging.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include "io/units.h"
#include "models/line/robust_line.h"
#include "models/median.h"
#include "models/turntable/compress.h"

namespace scancal::turntable {
namespace {

constexpr double kOff = 6;  // robust standard deviations: two points in 1e9 of a normal distribution
constexpr size_t kFewestPoints = 5;
constexpr double kRounding = 1e-7;  // of a profile's extent: what is nearer to its line is on it
const char kReasonOffLine[] = "off the line of their profile", kReasonOffPlane[] = "off the plane of their target";

constexpr double kOffPlane = 6;  // median distances of profiles
constexpr size_t kSubsample = 48, kFewestProfiles = 6;
constexpr double kRounding_mm = 1e-6;  // nearer than this is on the plane
constexpr double kSlack = 0.01;        // of a range: rounded angles and uneven lines are not outside

double Extent(const RawProfile& profile) {
  const auto [y0, y1] = std::minmax_element(profile.y.begin(), profile.y.end());
  const auto [z0, z1] = std::minmax_element(profile.z.begin(), profile.z.end());
  return std::hypot(*y1 - *y0, *z1 - *z0);
}

// Removes the points whose distance is larger; returns how many.
double KeepWithin(const std::vector<double>& distances, double within, RawProfile* profile) {
  for (auto* column : {&profile->y, &profile->z, &profile->range}) {
    size_t i = 0;
    std::erase_if(*column, [&](double) { return distances[i++] > within; });
  }
  return static_cast<double>(std::count_if(distances.begin(), distances.end(), [&](double d) { return d > within; }));
}

// Removes the points off each profile's own line. A profile's scale is never taken smaller than the placement's median,
// nor than the steps in which the sensor measures.
double SetAsideOffLine(std::vector<RawProfile>* profiles) {
  std::vector<RobustLine> lines;
  std::vector<double> scales, resolutions;
  for (const RawProfile& profile : *profiles) {
    lines.push_back(FitRobustLine(profile.y, profile.z));
    if (profile.y.size() < kFewestPoints) continue;
    scales.push_back(lines.back().scale);
    resolutions.push_back(Resolution(profile.range.empty() ? profile.y : profile.range));
  }
  const double common = std::max(Median(scales), Median(resolutions));
  double removed = 0;
  for (size_t k = 0; k < profiles->size(); ++k) {
    RawProfile& profile = (*profiles)[k];
    if (profile.y.size() < kFewestPoints) continue;
    const double within = std::max(kOff * std::max(lines[k].scale, common), kRounding * Extent(profile));
    std::vector<double> distances;
    for (size_t i = 0; i < profile.y.size(); ++i)
      distances.push_back(std::abs(lines[k].Distance(profile.y[i], profile.z[i])));
    removed += KeepWithin(distances, within, &profile);
  }
  return removed;
}

// The plane on which most profiles of a placement lie, whatever the others see.
struct RobustPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), through = Eigen::Vector3d::Zero();
  std::vector<bool> off;  // per profile: its rms distance is more than kOffPlane times the median
  double Distance(const Eigen::Vector3d& p) const { return normal.dot(p - through); }
};

using Points = std::array<Eigen::Vector3d, 3>;  // of one profile

double Rms(const RobustPlane& plane, const Points& profile) {
  double sum = 0;
  for (const Eigen::Vector3d& p : profile) sum += std::pow(plane.Distance(p), 2);
  return std::sqrt(sum / static_cast<double>(profile.size()));
}

// Total least squares of the profiles named. A start only, so the scatter matrix is good enough.
RobustPlane FitPlane(const std::vector<Points>& profiles, const std::vector<size_t>& which) {
  RobustPlane plane;
  const double n = 3.0 * static_cast<double>(which.size());
  for (const size_t k : which)
    for (const Eigen::Vector3d& p : profiles[k]) plane.through += p / n;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const size_t k : which)
    for (const Eigen::Vector3d& p : profiles[k]) scatter += (p - plane.through) * (p - plane.through).transpose();
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  return plane;
}

std::vector<double> Distances(const RobustPlane& plane, const std::vector<Points>& profiles) {
  std::vector<double> distances;
  for (const Points& profile : profiles) distances.push_back(Rms(plane, profile));
  return distances;
}

// The plane through two profiles with the least median distance; profiles in the order of their angles.
RobustPlane LeastMedian(const std::vector<Points>& ordered) {
  std::vector<Points> sample;
  const size_t n = std::min(ordered.size(), kSubsample);
  for (size_t k = 0; k < n; ++k) sample.push_back(ordered[k * ordered.size() / n]);
  RobustPlane best;
  double least = std::numeric_limits<double>::infinity();
  for (const size_t apart : {n / 2, n / 3}) {
    for (size_t i = 0; i + apart < n; ++i) {
      const RobustPlane plane = FitPlane(sample, {i, i + apart});
      const double median = Median(Distances(plane, sample));
      if (median < least) {
        least = median;
        best = plane;
      }
    }
  }
  return best;
}

// Least median of squares over pairs of profiles, then total least squares on those that are not off. Up to 40 % of the
// profiles may see something else. system: near the truth; an error there bends the plane and widens the median.
// Fewer than six profiles are never off.
RobustPlane FitRobustPlane(const std::vector<Profile>& profiles, const System& system) {
  std::vector<size_t> order(profiles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return profiles[a].alpha < profiles[b].alpha; });
  std::vector<Points> points;
  const std::vector<Model::View> views = PlaneViews(profiles, system);
  for (const size_t k : order) {
    const ProfileInTable<double> in_table = system.At(profiles[k].alpha);
    Points& profile = points.emplace_back();
    for (int i = 0; i < 3; ++i) profile[static_cast<size_t>(i)] = PointOf(in_table, views[k], i);
  }
  std::vector<size_t> on(points.size());
  std::iota(on.begin(), on.end(), 0);
  std::vector<bool> off(profiles.size(), false);
  if (profiles.size() >= kFewestProfiles) {
    RobustPlane plane = LeastMedian(points);
    for (int round = 0; round < 4; ++round) {
      const std::vector<double> distances = Distances(plane, points);
      const double within = std::max(kOffPlane * Median(distances), kRounding_mm);
      on.clear();
      for (size_t k = 0; k < points.size(); ++k) {
        off[order[k]] = distances[k] > within;
        if (distances[k] <= within) on.push_back(k);
      }
      plane = FitPlane(points, on);
    }
  }
  RobustPlane result = FitPlane(points, on);
  result.off = std::move(off);
  return result;
}

// Removes the points off the plane of most profiles, by the distances' own robust scale.
double SetAsideOffPlane(const System& system, std::vector<RawProfile>* profiles) {
  std::vector<Profile> compressed;
  for (const RawProfile& profile : *profiles)
    compressed.push_back(CompressProfile(profile.alpha, profile.y, profile.z, {}));
  const RobustPlane plane = FitRobustPlane(compressed, system);
  std::vector<std::vector<double>> distances;
  std::vector<double> on;
  for (size_t k = 0; k < profiles->size(); ++k) {
    const RawProfile& profile = (*profiles)[k];
    std::vector<double>& of_profile = distances.emplace_back();
    const ProfileInTable<double> in_table = system.At(profile.alpha);
    for (size_t i = 0; i < profile.y.size(); ++i)
      of_profile.push_back(
          std::abs(plane.Distance(in_table.Point(profile.y[i], profile.z[i], system.Bend(profile.y[i])))));
    if (!plane.off[k]) on.insert(on.end(), of_profile.begin(), of_profile.end());
  }
  const double within = std::max(kOff * kMadToSigma * Median(on), kRounding * Extent(profiles->front()));
  double removed = 0;
  for (size_t k = 0; k < profiles->size(); ++k) removed += KeepWithin(distances[k], within, &(*profiles)[k]);
  std::erase_if(*profiles, [](const RawProfile& profile) { return profile.y.empty(); });
  return removed;
}

void LookAtResiduals(const std::vector<RawProfile>& raw, Placement* placement) {
  placement->histogram.scale = placement->Pure().sigma();
  for (size_t k = 0; k < raw.size(); ++k) {
    const Profile& profile = placement->profiles[k];
    if (profile.pure_error.dof == 0) continue;
    const std::vector<double> residuals = ResidualsFromLine(profile, raw[k].y, raw[k].z);
    placement->lag_sums.Add(residuals);
    placement->histogram.Add(residuals);
  }
}

bool Within(double value, const std::array<double, 2>& range) {
  const double slack = kSlack * (range[1] - range[0]);
  return value >= range[0] - slack && value <= range[1] + slack;
}

}  // namespace

double Placement::Points() const {
  double sum = 0;
  for (const Profile& profile : profiles) sum += profile.count;
  return sum;
}

double Placement::Sweep() const {
  const auto [lowest, highest] = std::minmax_element(profiles.begin(), profiles.end(),
                                                     [](const auto& a, const auto& b) { return a.alpha < b.alpha; });
  return highest->alpha - lowest->alpha;
}

PureError Placement::Pure() const {
  PureError sum;
  for (const Profile& profile : profiles) {
    sum.sum_of_squares += profile.pure_error.sum_of_squares;
    sum.dof += profile.pure_error.dof;
  }
  return sum;
}

PureError PureOf(const std::vector<Placement>& placements) {
  PureError sum;
  for (const Placement& placement : placements) {
    sum.sum_of_squares += placement.Pure().sum_of_squares;
    sum.dof += placement.Pure().dof;
  }
  return sum;
}

void Clean(RawScan* scan) {
  for (RawProfile& profile : scan->profiles) OrderAlongLine(&profile);
  scan->off_line = SetAsideOffLine(&scan->profiles);
}

Placement CompressPlacement(const RawScan& scan, const System& system) {
  Placement placement;
  placement.name = scan.name;
  placement.missing = scan.missing;
  placement.warning = scan.warning;
  if (scan.off_line > 0) placement.set_aside[kReasonOffLine] = scan.off_line;
  std::vector<RawProfile> profiles = scan.profiles;
  if (const double off = SetAsideOffPlane(system, &profiles); off > 0) placement.set_aside[kReasonOffPlane] = off;
  for (const RawProfile& profile : profiles) {
    for (const auto* column : {&profile.y, &profile.z})
      for (const double value : *column) placement.largest = std::max(placement.largest, std::abs(value));
    placement.profiles.push_back(CompressProfile(profile.alpha, profile.y, profile.z, profile.range));
  }
  LookAtResiduals(profiles, &placement);
  return placement;
}

void ScannedVolume::Extend(double at_alpha, double at_y, double at_z) {
  for (const auto& [range, value] : {std::pair{&alpha, at_alpha}, {&y, at_y}, {&z, at_z}})
    *range = {std::min((*range)[0], value), std::max((*range)[1], value)};
}

std::string ScannedVolume::Beyond(double at_alpha, double at_y, double at_z) const {
  const auto told = [](const char* name, double value, const std::array<double, 2>& range, const char* unit) {
    return fmt::format("{} = {:.4g} {} (scanned: {:.4g} to {:.4g} {})", name, value, unit, range[0], range[1], unit);
  };
  if (!Within(at_alpha, alpha))
    return told("alpha", at_alpha / kDegree, {alpha[0] / kDegree, alpha[1] / kDegree}, "deg");
  if (!Within(at_y, y)) return told("y", at_y, y, "mm");
  if (!Within(at_z, z)) return told("z", at_z, z, "mm");
  return "";
}

ScannedVolume VolumeOf(const std::vector<Placement>& placements) {
  ScannedVolume volume;
  for (const Placement& placement : placements)
    for (const Profile& profile : placement.profiles)
      for (const PseudoPoint& end : Ends(profile.factor)) volume.Extend(profile.alpha, end.y, end.z);
  return volume;
}

}  // namespace scancal::turntable

#include "models/turntable/placement.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "io/units.h"
#include "models/median.h"
#include "models/parts/robust_line.h"
#include "models/turntable/raw_profiles.h"
#include "models/turntable/robust_plane.h"

namespace scancal {
namespace {

constexpr double kOffLine = 6;  // robust standard deviations: two points in 1e9 of a normal distribution
constexpr size_t kFewestForRobust = 5;
constexpr double kRounding = 1e-7;              // of a profile's extent: what is nearer to its line is on it
constexpr double kImplausibleLength_mm = 50e3;  // no plate is seen from farther away
const char kReasonOffLine[] = "off the line of their profile", kReasonOffPlane[] = "off the plane of their target";

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
    if (profile.y.size() < kFewestForRobust) continue;
    scales.push_back(lines.back().scale);
    resolutions.push_back(Resolution(profile.range.empty() ? profile.y : profile.range));
  }
  const double common = std::max(Median(scales), Median(resolutions));
  double removed = 0;
  for (size_t k = 0; k < profiles->size(); ++k) {
    RawProfile& profile = (*profiles)[k];
    if (profile.y.size() < kFewestForRobust) continue;
    const double within = std::max(kOffLine * std::max(lines[k].scale, common), kRounding * Extent(profile));
    std::vector<double> distances;
    for (size_t i = 0; i < profile.y.size(); ++i)
      distances.push_back(std::abs(lines[k].Distance(profile.y[i], profile.z[i])));
    removed += KeepWithin(distances, within, &profile);
  }
  return removed;
}

// Removes the points off the plane of most profiles, by the distances' own robust scale.
double SetAsideOffPlane(const TurntablePose& pose, std::vector<RawProfile>* profiles) {
  std::vector<Profile> compressed;
  for (const RawProfile& profile : *profiles)
    compressed.push_back(CompressProfile(profile.alpha, profile.y, profile.z, {}));
  const RobustPlane plane = FitRobustPlane(Views(compressed, Turntable::Residuals::kPlane), pose);
  std::vector<std::vector<double>> distances;
  std::vector<double> on;
  for (size_t k = 0; k < profiles->size(); ++k) {
    const RawProfile& profile = (*profiles)[k];
    std::vector<double>& of_profile = distances.emplace_back();
    const Eigen::Affine3d table_from_sensor = pose.TableFromSensor(profile.alpha);
    for (size_t i = 0; i < profile.y.size(); ++i)
      of_profile.push_back(
          std::abs(plane.Distance(table_from_sensor * Eigen::Vector3d(0, profile.y[i], profile.z[i]))));
    if (!plane.off[k]) on.insert(on.end(), of_profile.begin(), of_profile.end());
  }
  const double within = std::max(kOffLine * kMadToSigma * Median(on), kRounding * Extent(profiles->front()));
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

Result<RawScan> ReadCleanScan(const ScanDeclaration& scan, double sense) {
  SCANCAL_ASSIGN_OR_RETURN(RawScan raw, ReadRawScan(scan, sense));
  Clean(&raw);
  return raw;
}

Placement CompressPlacement(const RawScan& scan, const TurntablePose& pose) {
  Placement placement;
  placement.name = scan.name;
  placement.missing = scan.missing;
  placement.warning = scan.warning;
  if (scan.off_line > 0) placement.set_aside[kReasonOffLine] = scan.off_line;
  std::vector<RawProfile> profiles = scan.profiles;
  if (const double off = SetAsideOffPlane(pose, &profiles); off > 0) placement.set_aside[kReasonOffPlane] = off;
  for (const RawProfile& profile : profiles) {
    for (const auto* column : {&profile.y, &profile.z})
      for (const double value : *column) placement.largest = std::max(placement.largest, std::abs(value));
    placement.profiles.push_back(CompressProfile(profile.alpha, profile.y, profile.z, profile.range));
  }
  LookAtResiduals(profiles, &placement);
  return placement;
}

ViewResiduals ResidualsOf(const Placement& placement) {
  const LineCorrelation along = Correlate(placement.lag_sums);
  const ResidualHistogram& histogram = placement.histogram;
  return {along.lags,
          along.correlation,
          along.length,
          along.dies_out,
          histogram.scale,
          ResidualHistogram::kLimit,
          {histogram.counts.begin(), histogram.counts.end()},
          histogram.below,
          histogram.above};
}

Result<void> CheckPlausible(const std::vector<Placement>& placements, const Units& units) {
  double widest = 0, largest = 0;
  for (const Placement& placement : placements) {
    const double sweep = placement.Sweep();
    widest = std::max(widest, sweep);
    largest = std::max(largest, placement.largest);
    if (sweep > std::numbers::pi)
      return Error{
          fmt::format("target {}: its angles span {:.4g} rad ({:.4g} deg), but a plane is seen over less than half "
                      "a turn; is units: angle: {} right (degrees declared as rad?)",
                      placement.name, sweep, sweep / kDegree, units.angle)};
    if (placement.largest > kImplausibleLength_mm)
      return Error{
          fmt::format("target {}: found a coordinate of {:.4g} m, expected less than {:g} m; is units: length: {} "
                      "right (mm declared as m?)",
                      placement.name, placement.largest / 1000, kImplausibleLength_mm / 1000, units.length)};
  }
  if (largest < 1)
    return Error{
        fmt::format("the largest coordinate is {:.4g} mm, expected the size of a plate; is units: length: {} right "
                    "(m declared as mm, mm as um?)",
                    largest, units.length)};
  if (widest == 0)
    return Error{"M, N: not determined: every target has one angle only; the profiler must turn while it scans"};
  if (widest < kDegree)
    return Error{
        fmt::format("the angles span {:.3g} deg, expected more than one; if the file holds radians (a sweep of "
                    "{:.3g} deg), declare angle: rad",
                    widest / kDegree, widest / kDegree / kDegree)};
  for (const Placement& placement : placements)
    if (placement.Sweep() == 0)
      return Error{fmt::format("target {}: its plane is not determined: it needs profiles at two angles or more",
                               placement.name)};
  return {};
}

}  // namespace scancal

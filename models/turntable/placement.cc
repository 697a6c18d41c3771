// A placement: what is off the lines of its profiles or off its plane is set aside, the rest compressed.
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>
#include "models/line/robust_line.h"
#include "models/median.h"
#include "models/turntable/compress.h"
#include "solver/dense.h"
#include "solver/parallel.h"

namespace scancal::turntable {
namespace {

constexpr double kOff = 6;  // robust standard deviations: two points in 1e9 of a normal distribution
constexpr size_t kFewestPoints = 5;
constexpr double kRounding = 1e-7;  // of a profile's extent: what is nearer to its line is on it
const char kReasonOffLine[] = "off the line of their profile", kReasonOffPlane[] = "off the plane of their target",
           kReasonCopied[] = "copies of others";

constexpr double kOffPlane = 6;  // median distances of profiles
constexpr size_t kSubsample = 48, kFewestProfiles = 6;
constexpr double kRounding_mm = 1e-6;  // nearer than this is on the plane

double Extent(const RawProfile& profile) {
  const auto [y0, y1] = std::minmax_element(profile.y.begin(), profile.y.end());
  const auto [z0, z1] = std::minmax_element(profile.z.begin(), profile.z.end());
  return std::hypot(*y1 - *y0, *z1 - *z0);
}

// Which points lie farther away; empty if none does.
std::vector<bool> Beyond(double within, std::span<const double> distances) {
  std::vector<bool> beyond;
  for (size_t i = 0; i < distances.size(); ++i) {
    if (!(distances[i] > within)) continue;
    beyond.resize(distances.size());
    beyond[i] = true;
  }
  return beyond;
}

void Remove(const std::vector<bool>& points, RawProfile* profile) {
  for (auto* column : {&profile->y, &profile->z, &profile->range}) {
    size_t i = 0;
    std::erase_if(*column, [&](double) { return points[i++]; });
  }
}

double CountOf(const std::vector<bool>& points) {
  return static_cast<double>(std::count(points.begin(), points.end(), true));
}

struct OwnLine {
  RobustLine line;
  double resolution = 0;  // of its points
};

std::vector<OwnLine> OwnLines(const std::vector<RawProfile>& profiles) {
  std::vector<OwnLine> lines(profiles.size());
  InParallel(profiles.size(), 0, [&](size_t k) {
    const RawProfile& profile = profiles[k];
    lines[k].line = FitRobustLine(profile.y, profile.z);
    if (profile.y.size() >= kFewestPoints)
      lines[k].resolution = Resolution(profile.range.empty() ? profile.y : profile.range);
  });
  return lines;
}

// The least scale that a profile is taken to have: the placement's median, or the steps in which the sensor measures.
double CommonScale(const std::vector<RawProfile>& profiles, const std::vector<OwnLine>& lines) {
  std::vector<double> scales, resolutions;
  for (size_t k = 0; k < profiles.size(); ++k) {
    if (profiles[k].y.size() < kFewestPoints) continue;
    scales.push_back(lines[k].line.scale);
    resolutions.push_back(lines[k].resolution);
  }
  return std::max(Median(scales), Median(resolutions));
}

// Removes the points off each profile's own line; returns their number.
double SetAsideOffLine(const std::vector<OwnLine>& lines, double common_scale, std::vector<RawProfile>* profiles) {
  double removed = 0;
  std::vector<double> distances;
  for (size_t k = 0; k < profiles->size(); ++k) {
    RawProfile& profile = (*profiles)[k];
    if (profile.y.size() < kFewestPoints) continue;
    const RobustLine& line = lines[k].line;
    const double within = std::max(kOff * std::max(line.scale, common_scale), kRounding * Extent(profile));
    distances.resize(profile.y.size());
    for (size_t i = 0; i < distances.size(); ++i) distances[i] = std::abs(line.Distance(profile.y[i], profile.z[i]));
    const std::vector<bool> off = Beyond(within, distances);
    if (!off.empty()) Remove(off, &profile);
    removed += CountOf(off);
  }
  return removed;
}

std::vector<Profile> Compressed(const std::vector<RawProfile>& profiles) {
  std::vector<Profile> compressed(profiles.size());
  InParallel(profiles.size(), 0, [&](size_t k) {
    const RawProfile& profile = profiles[k];
    compressed[k] = CompressProfile(profile.alpha, profile.y, profile.z, profile.range);
    compressed[k].time = profile.time;
    compressed[k].temperature = profile.temperature;
  });
  return compressed;
}

double Largest(const RawProfile& profile) {
  double largest = 0;
  for (const auto* column : {&profile.y, &profile.z})
    for (const double value : *column) largest = std::max(largest, std::abs(value));
  return largest;
}

void LookAt(const Profile& profile, const RawProfile& raw, LagSums* lag_sums, ResidualHistogram* histogram) {
  if (profile.pure_error.dof == 0) return;
  const std::vector<double> residuals = ResidualsFromLine(profile, raw.y, raw.z);
  lag_sums->Add(residuals);
  histogram->Add(residuals);
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
  plane.normal = EigenOf(scatter).vectors.col(0);
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
    for (int i = 0; i < 3; ++i) profile[static_cast<size_t>(i)] = PointOf(system, in_table, views[k], i);
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

// Of a profile's points from a plane, as the system sees them.
void DistancesFrom(const RobustPlane& plane, const System& system, const RawProfile& profile, std::span<double> to) {
  const ProfileInTable<double> in_table = system.At(profile.alpha);
  const Eigen::Vector3d n = in_table.TurnedBack(plane.normal);
  const double at_origin = n.dot(in_table.origin) - plane.normal.dot(plane.through);
  const double by_y = n.dot(in_table.along_y), by_z = n.dot(in_table.along_z), by_depth = n.dot(in_table.along_depth);
  const bool bends = system.Bends();
  for (size_t i = 0; i < to.size(); ++i) to[i] = at_origin + by_y * profile.y[i] + by_z * profile.z[i];
  for (size_t i = 0; i < to.size() && bends; ++i) to[i] += by_depth * system.Bend(profile.y[i], profile.z[i]);
  for (double& distance : to) distance = std::abs(distance);
}

// The points of a segment as seen from a plane: their mean distance and its standard deviation, exactly, from the
// segment's triangle.
struct SegmentFromPlane {
  double count, mean, deviation;
  std::array<double, 2> ends;
};
SegmentFromPlane FromPlane(const RobustPlane& plane, const System& system, double alpha, const ProfileFactor& segment) {
  const ProfileInTable<double> in_table = system.At(alpha);
  const Eigen::Vector3d n = in_table.TurnedBack(plane.normal);
  const double middle = segment(0, 2) / segment(0, 0), height = segment(0, 1) / segment(0, 0);
  const double at_origin = n.dot(in_table.origin) - plane.normal.dot(plane.through) +
                           n.dot(in_table.along_depth) * system.Bend(middle, height);
  const Eigen::Vector3d by(at_origin, n.dot(in_table.along_z), n.dot(in_table.along_y));  // of (1, z, y)
  const Eigen::Vector3d rotated = segment * by;
  SegmentFromPlane found{
      segment(0, 0) * segment(0, 0), rotated[0] / segment(0, 0), rotated.tail<2>().norm() / segment(0, 0), {}};
  const std::array<PseudoPoint, 2> ends = Ends(segment);
  for (const size_t k : {0, 1}) found.ends[k] = std::abs(by[0] + by[1] * ends[k].z + by[2] * ends[k].y);
  return found;
}

// Of |distance| over all points of the segments, each taken as normal.
double MedianDistance(const std::vector<SegmentFromPlane>& segments) {
  double all = 0, high = 0;
  for (const SegmentFromPlane& s : segments) {
    all += s.count;
    high = std::max(high, std::abs(s.mean) + 8 * s.deviation);
  }
  const auto below = [&](double distance) {
    double sum = 0;
    for (const SegmentFromPlane& s : segments) {
      const double root2 = std::max(s.deviation, 1e-12) * std::numbers::sqrt2;
      sum += s.count * (std::erf((distance - s.mean) / root2) + std::erf((distance + s.mean) / root2)) / 2;
    }
    return sum;
  };
  double low = 0;
  for (int k = 0; k < 40; ++k) {
    const double half = (low + high) / 2;
    (below(half) < all / 2 ? low : high) = half;
  }
  return high;
}

// The same of a scan whose points are gone: an eighth of a profile is on the plane or off it.
PointsOnPlane SetAsideSegments(const RawScan& scan, const RobustPlane& plane, const System& system) {
  std::vector<std::vector<SegmentFromPlane>> found;
  std::vector<SegmentFromPlane> on;
  for (size_t k = 0; k < scan.compressed.size(); ++k) {
    const Profile& profile = scan.compressed[k];
    auto& of_profile = found.emplace_back();
    for (const ProfileFactor& segment : profile.segments)
      of_profile.push_back(FromPlane(plane, system, profile.alpha, segment));
    if (!plane.off[k]) on.insert(on.end(), of_profile.begin(), of_profile.end());
  }
  const auto [low, high] = Ends(scan.compressed.front().factor);
  const double within =
      std::max(kOff * kMadToSigma * MedianDistance(on), kRounding * std::hypot(high.y - low.y, high.z - low.z));
  PointsOnPlane left;
  for (size_t k = 0; k < scan.compressed.size(); ++k) {
    const Profile& profile = scan.compressed[k];
    std::vector<ProfileFactor> kept;
    double off = 0;
    for (size_t i = 0; i < profile.segments.size(); ++i) {
      const SegmentFromPlane& segment = found[k][i];
      if (std::max(segment.ends[0], segment.ends[1]) <= within) kept.push_back(profile.segments[i]);
      else off += segment.count;
    }
    left.off += off;
    if (off == 0) left.compressed.push_back(profile);
    else if (!kept.empty()) {
      left.compressed.push_back(MakeProfile(profile.alpha, profile.count - off, std::move(kept), std::nullopt));
      left.compressed.back().time = profile.time;
      left.compressed.back().temperature = profile.temperature;
    }
  }
  return left;
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

PureError PureOf(const std::vector<Profile>& profiles) {
  PureError sum;
  for (const Profile& profile : profiles) {
    sum.sum_of_squares += profile.pure_error.sum_of_squares;
    sum.dof += profile.pure_error.dof;
  }
  return sum;
}

PureError Placement::Pure() const { return PureOf(profiles); }

PureError PureOf(const std::vector<Placement>& placements) {
  PureError sum;
  for (const Placement& placement : placements) {
    sum.sum_of_squares += placement.Pure().sum_of_squares;
    sum.dof += placement.Pure().dof;
  }
  return sum;
}

void Clean(RawScan* scan) {
  InParallel(scan->profiles.size(), 0, [&](size_t k) { OrderAlongLine(&scan->profiles[k]); });
  const std::vector<OwnLine> lines = OwnLines(scan->profiles);
  if (!scan->common_scale) scan->common_scale = CommonScale(scan->profiles, lines);
  scan->off_line += SetAsideOffLine(lines, *scan->common_scale, &scan->profiles);
  const bool first = scan->compressed.empty();
  std::vector<Profile> compressed = Compressed(scan->profiles);
  scan->compressed.insert(scan->compressed.end(), std::make_move_iterator(compressed.begin()),
                          std::make_move_iterator(compressed.end()));
  if (scan->holds_points) return;
  if (first) scan->seen.histogram.scale = PureOf(scan->compressed).sigma();
  for (size_t k = 0; k < scan->profiles.size(); ++k) {
    const RawProfile& raw = scan->profiles[k];
    for (const double y : raw.y)
      scan->seen.depths = {std::min(scan->seen.depths[0], y), std::max(scan->seen.depths[1], y)};
    scan->seen.largest = std::max(scan->seen.largest, Largest(raw));
    LookAt(scan->compressed[scan->compressed.size() - scan->profiles.size() + k], raw, &scan->seen.lag_sums,
           &scan->seen.histogram);
  }
  scan->profiles.clear();
}

PointsOnPlane SetAsideOffPlane(const RawScan& scan, const System& system) {
  const RobustPlane plane = FitRobustPlane(scan.compressed, system);
  if (!scan.holds_points) return SetAsideSegments(scan, plane, system);
  size_t points = 0;
  for (const RawProfile& profile : scan.profiles) points += profile.y.size();
  std::vector<double> on(points);
  points = 0;
  for (size_t k = 0; k < scan.profiles.size(); ++k) {
    if (plane.off[k]) continue;
    const RawProfile& profile = scan.profiles[k];
    DistancesFrom(plane, system, profile, std::span(on).subspan(points, profile.y.size()));
    points += profile.y.size();
  }
  on.resize(points);
  const double within = std::max(kOff * kMadToSigma * Median(std::move(on)), kRounding * Extent(scan.profiles.front()));
  std::vector<double> distances;
  PointsOnPlane left;
  for (size_t k = 0; k < scan.profiles.size(); ++k) {
    const RawProfile& profile = scan.profiles[k];
    distances.resize(profile.y.size());
    DistancesFrom(plane, system, profile, distances);
    const std::vector<bool> off = Beyond(within, distances);
    if (off.empty()) {
      left.profiles.push_back(&profile);
      left.compressed.push_back(scan.compressed[k]);
      continue;
    }
    left.off += CountOf(off);
    RawProfile rest = profile;
    Remove(off, &rest);
    if (rest.y.empty()) continue;
    left.compressed.push_back(CompressProfile(rest.alpha, rest.y, rest.z, rest.range));
    left.compressed.back().time = rest.time;
    left.compressed.back().temperature = rest.temperature;
    left.changed.push_back(std::move(rest));
    left.profiles.push_back(&left.changed.back());
  }
  return left;
}

Placement MakePlacement(const RawScan& scan, const PointsOnPlane& points) {
  Placement placement;
  placement.name = scan.name;
  placement.missing = scan.missing;
  placement.warnings = scan.warnings;
  placement.dialect = scan.dialect;
  placement.timed = scan.timed;
  if (scan.copied > 0) placement.set_aside[kReasonCopied] = scan.copied;
  if (scan.off_line > 0) placement.set_aside[kReasonOffLine] = scan.off_line;
  if (points.off > 0) placement.set_aside[kReasonOffPlane] = points.off;
  placement.profiles = points.compressed;
  for (size_t k = 0; k < placement.profiles.size() && !scan.timed; ++k)
    placement.profiles[k].time = static_cast<double>(k);
  placement.largest = scan.seen.largest;
  for (const RawProfile* profile : points.profiles) placement.largest = std::max(placement.largest, Largest(*profile));
  return placement;
}

void LookAtResiduals(const RawScan& scan, const PointsOnPlane& points, Placement* placement) {
  placement->lag_sums = scan.seen.lag_sums;
  placement->histogram = scan.seen.histogram;
  if (scan.holds_points) placement->histogram.scale = placement->Pure().sigma();
  for (size_t k = 0; k < points.profiles.size(); ++k)
    LookAt(placement->profiles[k], *points.profiles[k], &placement->lag_sums, &placement->histogram);
}

}  // namespace scancal::turntable

#include "models/turntable/robust_plane.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include "models/median.h"

namespace scancal {
namespace {

constexpr size_t kSubsample = 48, kFewest = 6;
constexpr double kRounding_mm = 1e-6;  // nearer than this is on the plane

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

}  // namespace

RobustPlane FitRobustPlane(std::span<const Turntable::View> profiles, const TurntablePose& pose) {
  std::vector<size_t> order(profiles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return profiles[a].alpha < profiles[b].alpha; });
  std::vector<Points> points;
  for (const size_t k : order) {
    Points& profile = points.emplace_back();
    for (size_t i = 0; i < 3; ++i)
      profile[i] = pose.Point(profiles[k].alpha, profiles[k].points[i].y, profiles[k].points[i].z);
  }
  std::vector<size_t> on(points.size());
  std::iota(on.begin(), on.end(), 0);
  std::vector<bool> off(profiles.size(), false);
  if (profiles.size() >= kFewest) {
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

}  // namespace scancal

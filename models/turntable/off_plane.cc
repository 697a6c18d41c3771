#include "models/turntable/off_plane.h"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace scancal {
namespace {

constexpr size_t kSubsample = 48, kFewest = 6;
constexpr double kOff = 6;             // median distances
constexpr double kRounding_mm = 1e-6;  // nearer than this is on the plane

using Points = std::array<Eigen::Vector3d, 3>;  // of one profile

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ(), through = Eigen::Vector3d::Zero();
  double Distance(const Points& profile) const {  // rms
    double sum = 0;
    for (const Eigen::Vector3d& p : profile) sum += std::pow(normal.dot(p - through), 2);
    return std::sqrt(sum / 3);
  }
};

// Total least squares of the profiles named. A start only, so the scatter matrix is good enough.
Plane FitPlane(const std::vector<Points>& profiles, const std::vector<size_t>& which) {
  Plane plane;
  const double n = 3.0 * static_cast<double>(which.size());
  for (const size_t k : which)
    for (const Eigen::Vector3d& p : profiles[k]) plane.through += p / n;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const size_t k : which)
    for (const Eigen::Vector3d& p : profiles[k]) scatter += (p - plane.through) * (p - plane.through).transpose();
  plane.normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  return plane;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> Distances(const Plane& plane, const std::vector<Points>& profiles) {
  std::vector<double> distances;
  for (const Points& profile : profiles) distances.push_back(plane.Distance(profile));
  return distances;
}

// The plane through two profiles with the least median distance; profiles in the order of their angles.
Plane LeastMedian(const std::vector<Points>& ordered) {
  std::vector<Points> sample;
  const size_t n = std::min(ordered.size(), kSubsample);
  for (size_t k = 0; k < n; ++k) sample.push_back(ordered[k * ordered.size() / n]);
  Plane best;
  double least = std::numeric_limits<double>::infinity();
  for (const size_t apart : {n / 2, n / 3}) {
    for (size_t i = 0; i + apart < n; ++i) {
      const Plane plane = FitPlane(sample, {i, i + apart});
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

std::vector<bool> OffPlane(const std::vector<Profile>& profiles, const TurntablePose& pose) {
  std::vector<bool> off(profiles.size(), false);
  if (profiles.size() < kFewest) return off;
  std::vector<size_t> order(profiles.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return profiles[a].alpha < profiles[b].alpha; });
  std::vector<Points> points;
  for (const size_t k : order) {
    Points& profile = points.emplace_back();
    const auto pseudo = PseudoPoints(profiles[k].factor);
    for (size_t i = 0; i < 3; ++i) profile[i] = pose.Point(profiles[k].alpha, pseudo[i].y, pseudo[i].z);
  }
  Plane plane = LeastMedian(points);
  std::vector<double> distances;
  double within = 0;
  for (int round = 0; round < 3; ++round) {
    distances = Distances(plane, points);
    within = std::max(kOff * Median(distances), kRounding_mm);
    std::vector<size_t> on;
    for (size_t k = 0; k < points.size(); ++k)
      if (distances[k] <= within) on.push_back(k);
    plane = FitPlane(points, on);
  }
  distances = Distances(plane, points);
  for (size_t k = 0; k < points.size(); ++k) off[order[k]] = distances[k] > within;
  return off;
}

}  // namespace scancal

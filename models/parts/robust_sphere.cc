#include "models/parts/robust_sphere.h"
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include "models/parts/median.h"
#include "solver/random.h"

namespace scancal {
namespace {

constexpr size_t kFewest = 8, kSubsample = 400;
constexpr int kDraws = 200, kRounds = 20;
constexpr double kRounding_mm = 1e-9;  // nearer than this is on the sphere

struct Ball {
  Eigen::Vector3d centre;
  double radius;
  double Off(const Eigen::Vector3d& p) const { return std::abs((p - centre).norm() - radius); }
};
using Points = std::vector<Eigen::Vector3d>;

// Through four points; none, or a wild one, if they lie on a circle.
void AppendThroughFour(const Points& p, std::vector<Ball>* balls) {
  Eigen::Matrix3d rows;
  Eigen::Vector3d right;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = p[static_cast<size_t>(k) + 1] - p[0];
    rows.row(k) = 2 * edge.transpose();
    right[k] = edge.squaredNorm();
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(rows);
  if (!lu.isInvertible()) return;
  const Eigen::Vector3d centre = lu.solve(right);
  balls->push_back({p[0] + centre, centre.norm()});
}

// Of a known radius through three points: one on either side, or none.
void AppendThroughThree(const Points& p, double radius, std::vector<Ball>* balls) {
  const Eigen::Vector3d a = p[1] - p[0], b = p[2] - p[0], normal = a.cross(b);
  if (normal.norm() <= 1e-9 * a.norm() * b.norm()) return;
  const Eigen::Vector3d middle =
      (a.squaredNorm() * b.cross(normal) + b.squaredNorm() * normal.cross(a)) / (2 * normal.squaredNorm());
  const double height = radius * radius - middle.squaredNorm();
  if (height < 0) return;
  for (const double side : {-1.0, 1.0})
    balls->push_back({p[0] + middle + side * std::sqrt(height) * normal.normalized(), radius});
}

std::vector<double> Distances(const Ball& ball, std::span<const Eigen::Vector3d> points) {
  std::vector<double> distances;
  for (const Eigen::Vector3d& p : points) distances.push_back(ball.Off(p));
  return distances;
}

// The one with the least median distance; of none an infinite one.
Ball LeastMedian(std::span<const Eigen::Vector3d> points, const SphereChoice& choice) {
  Random random(1, points.size());
  const auto draw = [&] { return points[static_cast<size_t>(random.Uniform() * static_cast<double>(points.size()))]; };
  Points sample;
  const size_t n = std::min(points.size(), kSubsample);
  for (size_t k = 0; k < n; ++k) sample.push_back(points[k * points.size() / n]);
  std::vector<Ball> balls;
  for (int k = 0; k < kDraws; ++k) {
    if (choice.radius) AppendThroughThree({draw(), draw(), draw()}, choice.radius->value, &balls);
    else AppendThroughFour({draw(), draw(), draw(), draw()}, &balls);
  }
  Ball best{points[0], std::numeric_limits<double>::infinity()};
  double least = best.radius;
  for (const Ball& ball : balls) {
    const double median = Median(Distances(ball, sample));
    if (median < least) {
      least = median;
      best = ball;
    }
  }
  return best;
}

}  // namespace

RobustSphere FitRobustSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice) {
  RobustSphere result;
  result.off.assign(points.size(), false);
  Ball ball{};
  if (points.size() >= kFewest) ball = LeastMedian(points, choice);
  if (!std::isfinite(ball.radius) || points.size() < kFewest) {
    result.fit = FitSphere(points, choice);
    return result;
  }
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> distances = Distances(ball, points);
    const double sigma = round == 0 ? kMadToSigma * Median(distances) : result.fit.sigma;
    const double within = std::max(kOffSphere * sigma, kRounding_mm);
    std::vector<bool> off(points.size());
    Points on;
    for (size_t i = 0; i < points.size(); ++i) {
      off[i] = distances[i] > within;
      if (!off[i]) on.push_back(points[i]);
    }
    if (round > 0 && off == result.off) break;
    result.off = std::move(off);
    result.set_aside = static_cast<int>(points.size() - on.size());
    result.fit = FitSphere(on, choice);
    ball = {result.fit.centre, result.fit.radius};
  }
  return result;
}

}  // namespace scancal

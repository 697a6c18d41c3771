// A sphere through measured points, whatever the others are.
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scancal {

// Signed distance of a point from a sphere: |p - centre| - radius, positive outside; mm. Not differentiable at the
// centre, where no measured point lies.
template <class T>
T SphereDistance(const T p[3], const T centre[3], const T& radius) {
  using std::sqrt;
  const T d[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - radius;
}

struct KnownRadius {
  double value = 0, u = 0;  // mm; u = 0: exactly
};

struct SphereChoice {
  std::optional<KnownRadius> radius;       // none: estimated
  std::optional<Eigen::Vector3d> outside;  // where the points are seen from: the centre lies behind them
};

struct SphereFit {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
  // Of centre and radius, mm^2: sigma^2 (J'J)^-1, right for independent points with one noise across the surface, and
  // what a known radius with u > 0 adds.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double sigma = 0;  // standard deviation of a point across the surface, by degrees of freedom
  double dof = 0;    // of sigma: points less what is estimated
  int iterations = 0;
  std::string doubt;  // why not to rely on it; empty: nothing found
};

// Least squares of the distances from the surface (orthogonal, "geometric"), from a start in closed form: the algebraic
// sphere |p|^2 = 2 p . c + (R^2 - |c|^2), which is linear; with a known radius, its centre moved along the normal of
// the cap until the mean square distance is R^2. A cap so flat that its noise hides the curvature fits on either side:
// `outside` decides. Not robust: leave out what is not on the sphere.
SphereFit FitSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice = {});

// Farther than this many standard deviations is not on the sphere: of a normal distribution one point in 16,000.
inline constexpr double kOffSphere = 4;

struct RobustSphere {
  SphereFit fit;          // of the points that are not off
  std::vector<bool> off;  // per point
  int set_aside = 0;      // of them
};

// Least median of squares over spheres through a few points drawn from a fixed seed, then FitSphere of the points that
// are not off, until these stay the same. Up to 40 % of the points may lie elsewhere: on the stem, the floor, at edges.
// Fewer than eight points are never off.
RobustSphere FitRobustSphere(std::span<const Eigen::Vector3d> points, const SphereChoice& choice = {});

}  // namespace scancal

#include "tests/robot_study/configurations.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "models/robot_ball/published.h"
#include "models/robot_ball/start.h"
#include "models/sphere.h"
#include "solver/parallel.h"
#include "solver/random.h"

namespace scancal::robot_study {
namespace {

using Eigen::Vector3d;

// Points on the side of a ball that faces the scanner, within 60 degrees of its top; they sit on the measured centre.
std::vector<Vector3d> CapOf(const Vector3d& centre, Random* random) {
  constexpr int kPoints = 60;
  constexpr double kLowest = 0.5;  // cosine
  std::vector<Vector3d> points;
  for (int k = 0; k < kPoints; ++k) {
    const double z = kLowest + (1 - kLowest) * random->Uniform(), turn = 2 * std::numbers::pi * random->Uniform();
    const double across = std::sqrt(1 - z * z);
    points.push_back(centre + kBallRadius * Vector3d(across * std::cos(turn), across * std::sin(turn), z));
  }
  return points;
}

// One sphere through the points of all poses that see the first pose's first ball.
double Radius(const robot_ball::Measurements& data, const robot_ball::Kinematics& setup, uint64_t seed) {
  constexpr uint64_t kPointStream = uint64_t{5} << 32;
  Random random(seed, kPointStream);
  const std::vector<robot_ball::Model::View>& views = data.stations.front().views;
  const int sphere = views.front().balls.front().sphere;
  std::vector<Vector3d> in_base;
  for (const robot_ball::Model::View& view : views)
    for (const robot_ball::Model::SeenBall& ball : view.balls)
      if (ball.sphere == sphere)
        for (const Vector3d& point : CapOf(ball.centre, &random))
          in_base.push_back(BaseFromScanner(data, setup, view) * point);
  return FitSphere(in_base).radius;
}

}  // namespace

double Reconstruction::Error(double share) const {
  Eigen::VectorXd errors = (radius.array() - kBallRadius).abs();
  std::sort(errors.begin(), errors.end());
  return errors[static_cast<Eigen::Index>(share * static_cast<double>(errors.size() - 1))];
}

std::vector<Reconstruction> StudyConfigurations(const robot_ball::Scene& scene, size_t sets, int threads) {
  using enum robot_ball::PoseConfiguration;
  std::vector<Reconstruction> results;
  for (const robot_ball::PoseConfiguration configuration : {kCollinear, kPlanar, kSpatial})
    results.push_back({configuration, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sets))});
  InParallel(sets, threads, [&](size_t set) {
    robot_ball::Scene own = scene;
    own.stations = 1;
    own.check_positions = 0;
    own.seed = scene.seed + 2 * set;
    own.noise_seed = scene.noise_seed + 2 * set;
    robot_ball::Scene other = own;
    other.configuration = kSpatial;
    other.translations = 0;
    other.poses = 16;  // eight of either end
    ++other.seed;
    ++other.noise_seed;
    const robot_ball::Measurements evaluated = robot_ball::Simulate(other).data;
    for (Reconstruction& result : results) {
      own.configuration = result.configuration;
      const Result<robot_ball::Kinematics> setup = Ren2012(robot_ball::Simulate(own).data);
      CHECK(setup.ok()) << "seed " << own.seed << ": " << setup.error().message;
      result.radius[static_cast<Eigen::Index>(set)] = Radius(evaluated, *setup, other.noise_seed);
    }
  });
  return results;
}

}  // namespace scancal::robot_study

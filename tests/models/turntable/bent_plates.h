// Bent plates before a profiler or a lidar, for the tables of figures.
#pragma once
#include <gtest/gtest.h>
#include <cmath>
#include "io/units.h"
#include "models/turntable/scanner.h"
#include "solver/random.h"

namespace scancal::turntable::bent_plates {

inline constexpr int kPoints = 40;  // five in every segment

struct Point {
  double alpha = 0, y = 0, z = 0;
};

struct ScannedPlates {
  std::vector<std::vector<Point>> points;  // per placement
  std::vector<Placement> placements;
};

// Three bent plates before a profiler, or a lidar that stands farther back.
inline ScannedPlates Scanned(int profiles, bool lidar = false) {
  const System truth{{123, lidar ? 50.0 : 409.0}, {}};
  ScannedPlates scene;
  Random random(1, 0);
  for (const auto& [turn, lean] : {std::pair{-25 * kDegree, 12 * kDegree}, {0, -8 * kDegree}, {25 * kDegree, 0.2}}) {
    const Eigen::Vector3d normal(std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean));
    std::vector<Point>& points = scene.points.emplace_back();
    Placement& placement = scene.placements.emplace_back();
    placement.name = "plate " + std::to_string(scene.placements.size());
    placement.largest = 500;
    for (int i = 0; i < profiles; ++i) {
      const double alpha = 30 * kDegree * (i / std::max(1.0, profiles - 1.0) - 0.5);
      std::vector<double> y, z, range;
      for (int j = 0; j < kPoints; ++j) {
        z.push_back(200 * (j / (kPoints - 1.0) - 0.5));
        const Eigen::Vector3d origin = truth.Point(alpha, 0, z.back()),
                              along = truth.Point(alpha, 1, z.back()) - origin;
        y.push_back((480 - normal.dot(origin)) / normal.dot(along) + 1e-5 * z.back() * z.back() +
                    0.01 * random.Normal());
        if (lidar) range.push_back(std::hypot(y.back(), z.back()));
        points.push_back({alpha, y.back(), z.back()});
      }
      placement.profiles.push_back(CompressProfile(alpha, y, z, range));
    }
  }
  return scene;
}

inline Scanner ScannerOf(std::vector<Placement> placements, const GridBox& box = {{110, 395}, {130, 425}, 1}) {
  Declaration declaration;
  declaration.search = box;
  return {declaration, Model(Model::Residuals::kDepth), std::move(placements)};
}

inline Calibration Calibrated(const Scanner& scanner, const RefineChoice& choice = {}) {
  const Result<Calibration> calibration = scanner.Calibrate(choice);
  EXPECT_TRUE(calibration.ok()) << calibration.error().message;
  return calibration.ok() ? *calibration : Calibration();
}

// Measured minus predicted along the line of sight, with the result's own numbers.
inline double ResidualOf(const Point& p, const Calibration& c, size_t target, bool lidar = false) {
  const System system{{c.Find("M")->value, c.Find("N")->value}, {}};
  const Eigen::Vector3d normal = Eigen::Vector3d::Map(c.targets[target].geometry.at("normal").data()),
                        measured = system.Point(p.alpha, p.y, p.z), from = system.Point(p.alpha, 0, lidar ? 0 : p.z);
  return (normal.dot(measured) - c.targets[target].geometry.at("distance")[0]) /
         normal.dot((measured - from).normalized());
}

}  // namespace scancal::turntable::bent_plates

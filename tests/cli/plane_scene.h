// Noiseless or noisy scans of planes of the test's own choice: an independent way to write the model down.
#pragma once
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>
#include "io/units.h"
#include "tests/cli/data_set.h"

namespace scancal {

// n . P = d with n turned by `turn` about the axis and leaning by `lean` against it, in degrees.
struct PlaneOfTest {
  double turn = 0, lean = 0, distance = 480;
};

struct PlaneScene {
  double M = 123, N = 409, noise = 0.01, sweep = 30;  // mm, deg
  int profiles = 40, points = 20;
  std::vector<PlaneOfTest> planes;
};

// Depth of the plane along the profiler's line of sight, from eq. (7): x = M cos a - (N + y) sin a, y = -M sin a - (N +
// y) cos a.
inline double DepthOfPlane(const PlaneScene& scene, const PlaneOfTest& plane, double angle, double z) {
  const double a = angle * kDegree, turn = plane.turn * kDegree, lean = plane.lean * kDegree;
  const std::array<double, 3> n = {std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean)};
  const double at_zero = n[0] * (scene.M * std::cos(a) - scene.N * std::sin(a)) +
                         n[1] * (-scene.M * std::sin(a) - scene.N * std::cos(a)) + n[2] * z;
  return (plane.distance - at_zero) / (-n[0] * std::sin(a) - n[1] * std::cos(a));
}

inline std::vector<ScanPoint> ScanOf(const PlaneScene& scene, const PlaneOfTest& plane, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 1);
  std::vector<ScanPoint> points;
  for (int i = 0; i < scene.profiles; ++i) {
    const double angle = scene.sweep * (static_cast<double>(i) / std::max(1, scene.profiles - 1) - 0.5);
    for (int j = 0; j < scene.points; ++j) {
      const double z = 200 * (static_cast<double>(j) / (scene.points - 1) - 0.5);
      points.push_back({angle, DepthOfPlane(scene, plane, angle, z) + scene.noise * noise(random), z});
    }
  }
  return points;
}

// Targets plane_1, plane_2, ... in CSV files of those names.
inline void WriteScene(const fs::path& folder, const PlaneScene& scene, const std::string& more_yaml = "") {
  fs::create_directories(folder);
  std::string yaml =
      "scancal: 1\nmodel: turntable\nunits: {length: mm, angle: deg}\nrotation: clockwise\n"
      "search: {M: [110, 130], N: [395, 425], step: 1}\n" +
      more_yaml + "targets:\n";
  for (size_t k = 0; k < scene.planes.size(); ++k) {
    const std::string name = "plane_" + std::to_string(k + 1);
    WritePoints(folder / (name + ".csv"), ScanOf(scene, scene.planes[k], static_cast<unsigned>(k)));
    yaml += "  - {name: " + name + ", scan: " + name + ".csv}\n";
  }
  WriteWhole(folder / "dataset.yaml", yaml);
}

}  // namespace scancal

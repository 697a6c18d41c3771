#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include "models/turntable/scanner.h"
#include "solver/random.h"
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

constexpr int kPlacements = 3;

// Profiles of a plate with white noise, each compressed before the next is made: no more than one is ever held.
std::vector<Placement> MakeCompressed(int profiles_per_placement, int points_per_profile) {
  turntable::Scene scene = LargeScene();
  scene.profiles = scene.points = 1;  // for the planes
  const std::vector<SimulatedPlacement> planes = turntable::Simulate(scene);
  std::vector<Placement> placements;
  std::vector<double> y(points_per_profile), z(points_per_profile);
  for (int t = 0; t < kPlacements; ++t) {
    Random random(scene.seed, static_cast<uint64_t>(100 + t));
    Placement& placement = placements.emplace_back();
    placement.name = planes[t].name;
    for (int k = 0; k < profiles_per_placement; ++k) {
      const double alpha = scene.sweep * ((k + 0.5) / profiles_per_placement - 0.5);
      const Eigen::Vector3d origin = scene.system.Point(alpha, 0, 0);
      const double by_y = planes[t].normal.dot(scene.system.Point(alpha, 1, 0) - origin);
      const double by_z = planes[t].normal.dot(scene.system.Point(alpha, 0, 1) - origin);
      for (int i = 0; i < points_per_profile; ++i) {
        z[i] = scene.line_length * ((i + 0.5) / points_per_profile - 0.5);
        y[i] =
            (planes[t].distance - planes[t].normal.dot(origin) - by_z * z[i]) / by_y + scene.noise_y * random.Normal();
      }
      placement.profiles.push_back(turntable::CompressProfile(alpha, y, z, {}));
    }
    placement.largest = 1000;
  }
  return placements;
}

// Everything between reading and the report: the grid at step 1, the refinement, all uncertainties.
std::vector<double> CalibrationSeconds(const std::vector<std::vector<Placement>>& cases) {
  std::vector<std::function<void()>> works;
  for (const std::vector<Placement>& placements : cases) {
    turntable::Declaration declaration;
    declaration.search = {{110, 395}, {130, 425}, 1};
    const auto scanner = std::make_shared<const turntable::Scanner>(
        declaration, turntable::Model(turntable::Model::Residuals::kDepth), placements);
    works.emplace_back([scanner] {
      const Result<Calibration> calibration = scanner->Calibrate({});
      CHECK(calibration.ok()) << calibration.error().message;
      CHECK(calibration->converged);
    });
  }
  return MedianSecondsOf(works);
}

void ComparePoints(Table* table) {
  Say("everything after reading: more points");
  constexpr int kProfiles = 600;
  constexpr std::array kPowers = {4, 5, 6, 7};
  std::vector<std::vector<Placement>> cases;
  for (const int power : kPowers)
    cases.push_back(MakeCompressed(kProfiles / kPlacements, static_cast<int>(std::pow(10, power) / kProfiles)));
  const std::vector<double> seconds = CalibrationSeconds(cases);
  for (size_t k = 0; k < kPowers.size(); ++k)
    table->Add({fmt::format("after reading, {} profiles, about 10^{} points; other: 10^4", kProfiles, kPowers[k]),
                Seconds(seconds[k]), Seconds(seconds[0]), Ratio(seconds[k] / seconds[0]), "", ""});
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  table->AddAtMost("... flat in the points: slowest / fastest", Seconds(*most), Seconds(*least), Ratio(*most / *least),
                   *most / *least, 1.5);
}

void CompareProfiles(Table* table) {
  Say("everything after reading: more profiles");
  constexpr std::array kProfiles = {150, 300, 600, 1200, 2400, 4800};
  std::vector<std::vector<Placement>> cases;
  for (const int profiles : kProfiles) cases.push_back(MakeCompressed(profiles / kPlacements, 100));
  const std::vector<double> seconds = CalibrationSeconds(cases);
  std::vector<double> each;
  for (size_t k = 0; k < kProfiles.size(); ++k) {
    each.push_back(seconds[k] / kProfiles[k]);
    table->Add(
        {fmt::format("after reading, {} profiles, {}; per profile; other: 150", kProfiles[k], Seconds(seconds[k])),
         Seconds(each[k]), Seconds(each[0]), Ratio(each[k] / each[0]), "", ""});
  }
  const double least = *std::min_element(each.begin(), each.end()), growth = each.back() / least;
  table->AddAtMost("... linear in the profiles: each of 4800 / cheapest", Seconds(each.back()), Seconds(least),
                   Ratio(growth), growth, 1.5);
}

}  // namespace

void CompareScaling(Table* table) {
  ComparePoints(table);
  CompareProfiles(table);
  table->Note("After reading: grid at step 1 (651 nodes), depth residual, linearization, all covariances, jackknife.");
}

}  // namespace scancal::bench

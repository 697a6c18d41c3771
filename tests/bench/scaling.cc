#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "models/turntable/turntable_scanner.h"
#include "solver/random.h"
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

constexpr int kPlacements = 3;

// Profiles of a plate with white noise, each compressed before the next is made: no more than one is ever held.
std::vector<Placement> MakeCompressed(int profiles_per_placement, int points_per_profile) {
  TurntableScene scene = LargeScene();
  scene.profiles = scene.points = 1;  // for the planes
  const std::vector<SimulatedPlacement> planes = SimulateTurntable(scene);
  std::vector<Placement> placements;
  std::vector<double> y(points_per_profile), z(points_per_profile);
  for (int t = 0; t < kPlacements; ++t) {
    Random random(scene.seed, static_cast<uint64_t>(100 + t));
    Placement& placement = placements.emplace_back();
    placement.name = planes[t].name;
    for (int k = 0; k < profiles_per_placement; ++k) {
      const double alpha = scene.sweep * ((k + 0.5) / profiles_per_placement - 0.5);
      const Eigen::Vector3d origin = scene.pose.Point(alpha, 0, 0);
      const double by_y = planes[t].normal.dot(scene.pose.Point(alpha, 1, 0) - origin);
      const double by_z = planes[t].normal.dot(scene.pose.Point(alpha, 0, 1) - origin);
      for (int i = 0; i < points_per_profile; ++i) {
        z[i] = scene.line_length * ((i + 0.5) / points_per_profile - 0.5);
        y[i] =
            (planes[t].distance - planes[t].normal.dot(origin) - by_z * z[i]) / by_y + scene.noise_y * random.Normal();
      }
      placement.profiles.push_back(CompressProfile(alpha, y, z, {}));
    }
    placement.largest = 1000;
  }
  return placements;
}

// Everything between reading and the report: the grid at step 1, the refinement, all uncertainties.
double CalibrationSeconds(const std::vector<Placement>& placements) {
  TurntableDeclaration declaration;
  declaration.search = {{110, 395}, {130, 425}, 1};
  const TurntableScanner scanner(declaration, Turntable(Turntable::Residuals::kDepth), placements);
  return MedianSecondsOf([&] {
    const Result<Calibration> calibration = scanner.Calibrate({});
    CHECK(calibration.ok()) << calibration.error().message;
    CHECK(calibration->converged);
  });
}

}  // namespace

void CompareScaling(Table* table) {
  Say("everything after reading: more points");
  constexpr int kProfiles = 600;
  std::vector<double> seconds;
  for (const double points : {1e4, 1e5, 1e6, 1e7}) {
    const int per_profile = static_cast<int>(std::lround(points / kProfiles));
    seconds.push_back(CalibrationSeconds(MakeCompressed(kProfiles / kPlacements, per_profile)));
    table->Add({fmt::format("everything after reading, {} profiles, about 10^{:.0f} points (other: 10^4)", kProfiles,
                            std::log10(points)),
                Seconds(seconds.back()), Seconds(seconds.front()), Ratio(seconds.back() / seconds.front()), "", ""});
  }
  const auto [least, most] = std::minmax_element(seconds.begin(), seconds.end());
  table->AddAtMost("... flat in the points: slowest / fastest", Seconds(*most), Seconds(*least), Ratio(*most / *least),
                   *most / *least, 1.5);

  Say("everything after reading: more profiles");
  std::vector<double> per_profile;
  for (const int profiles : {150, 300, 600, 1200, 2400, 4800}) {
    seconds.push_back(CalibrationSeconds(MakeCompressed(profiles / kPlacements, 100)));
    per_profile.push_back(seconds.back() / profiles);
    table->Add({fmt::format("everything after reading, {} profiles; per profile (other: 150)", profiles),
                Seconds(seconds.back()) + "; " + Seconds(per_profile.back()), Seconds(per_profile.front()),
                Ratio(per_profile.back() / per_profile.front()), "", ""});
  }
  const double growth = per_profile.back() / *std::min_element(per_profile.begin(), per_profile.end());
  table->AddAtMost("... linear in the profiles: per profile, 4800 / cheapest", Seconds(per_profile.back()),
                   Seconds(*std::min_element(per_profile.begin(), per_profile.end())), Ratio(growth), growth, 1.5);
  table->Note("After reading: grid at step 1 (651 nodes), depth residual, linearization, all covariances, jackknife.");
}

}  // namespace scancal::bench

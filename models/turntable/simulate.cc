#include "models/turntable/simulate.h"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include "io/units.h"
#include "models/turntable/volume.h"
#include "solver/random.h"

namespace scancal {

using turntable::System;

namespace {

constexpr double kStandoff = 75;                         // mm from the profiler's zero to the plate, straight ahead
constexpr double kSpike = 30;                            // mm
constexpr double kNearestWall = 30, kFarthestWall = 60;  // mm behind the plate
constexpr int kSteps = 10, kRounds = 4;
constexpr double kSettled_mm = 1e-9;
constexpr double kLeastHalf = 1;  // mm: of what is seen of a plate by a single profile or point
// Placements have the streams 1, 2, ...
constexpr uint64_t kFormStreams = uint64_t{1} << 32, kBackgroundStreams = uint64_t{2} << 32;

struct Plate {
  Eigen::Vector3d normal, centre, across, up;
  PlateForm form;
};

// Names as in the paper for three placements: left, centre, right.
std::string NameOf(int placement, int placements) {
  static const char* const kThree[] = {"left", "centre", "right"};
  return placements == 3 ? kThree[placement] : "placement_" + std::to_string(placement + 1);
}

Plate PlacePlate(const TurntableScene& scene, int placement) {
  // Turned about the axis from -25 to 25 degrees; leaning towards and away from the axis in turn, by 5 to 20 degrees.
  static constexpr double kLean[] = {12, -8, 16, -14, 6, -19};
  const double turned = scene.placements == 1 ? 0 : -25 + 50.0 * placement / (scene.placements - 1);
  const double lean = kLean[placement % 6] * kDegree, turn = turned * kDegree;
  Plate plate;
  plate.normal = {std::sin(turn) * std::cos(lean), -std::cos(turn) * std::cos(lean), std::sin(lean)};
  System straight = scene.system;
  straight[Turntable::kLinearity] = 0;
  plate.centre = straight.Point(0, kStandoff, 0);
  plate.across = plate.normal.cross(Eigen::Vector3d::UnitZ()).normalized();
  plate.up = plate.across.cross(plate.normal);
  return plate;
}

// The depth that the profiler shows where its encoder reads alpha and it sees z of the plate with its form. Affine in y
// but for form and linearity, whose slopes are small: a few steps settle it.
double ShownDepth(const System& system, const Plate& plate, double alpha, double z) {
  const turntable::ProfileInTable<double> in_table = system.At(alpha);
  const auto at = [&](double y, double bend) -> Eigen::Vector3d {
    return Eigen::Vector3d::Map(in_table.Point(y, z, bend).data());
  };
  const double by_y = plate.normal.dot(at(1, 0) - at(0, 0));
  double y = 0;
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::Vector3d p = at(y, k == 0 ? 0 : system.Bend(y)) - plate.centre;
    const double height = k == 0 ? 0 : plate.form.At(plate.across.dot(p), plate.up.dot(p));
    const double step = (height - plate.normal.dot(p)) / by_y;
    y += step;
    if (k > 0 && std::abs(step) < kSettled_mm) break;
  }
  return y;
}

// From -extent / 2 to extent / 2.
double Spread(double extent, int index, int count) {
  return count == 1 ? 0 : extent * (static_cast<double>(index) / (count - 1) - 0.5);
}

// What the scan sees of the plate, were it flat.
PlateRectangle ScannedRectangle(const TurntableScene& scene, const System& system, const Plate& flat) {
  Eigen::AlignedBox2d box;
  for (int i = 0; i < scene.profiles; ++i) {
    for (int j = 0; j < scene.points; ++j) {
      const double alpha = Spread(scene.sweep, i, scene.profiles), z = Spread(scene.line_length, j, scene.points);
      const Eigen::Vector3d p = system.Point(alpha, ShownDepth(system, flat, alpha, z), z) - flat.centre;
      box.extend(Eigen::Vector2d(flat.across.dot(p), flat.up.dot(p)));
    }
  }
  const Eigen::Vector2d half = (box.sizes() / 2).cwiseMax(kLeastHalf);
  return {box.center().x(), box.center().y(), half.x(), half.y()};
}

PlateForm FormOf(const TurntableScene& scene, const System& system, int placement, const Plate& flat) {
  if (scene.form == 0) return {};
  const uint64_t stream = kFormStreams + (scene.one_plate ? 0 : static_cast<uint64_t>(placement));
  return {scene.form_kind, scene.form, ScannedRectangle(scene, system, flat), Random(scene.seed, stream)};
}

// A wall behind the plate, seen at one end of each line.
class Background {
 public:
  Background(const TurntableScene& scene, int placement)
      : random_(scene.seed, kBackgroundStreams + static_cast<uint64_t>(placement)),
        behind_(kNearestWall + (kFarthestWall - kNearestWall) * random_.Uniform()),
        points_(scene.points),
        covered_(static_cast<int>(std::lround(scene.background * scene.points))) {}
  void NextProfile() { at_start_ = random_.Uniform() < 0.5; }
  double Behind(int point) const {  // mm along depth
    const bool covered = at_start_ ? point < covered_ : point >= points_ - covered_;
    return covered ? behind_ : 0;
  }

 private:
  Random random_;
  double behind_;
  int points_, covered_;
  bool at_start_ = true;
};

}  // namespace

System WithDepths(const TurntableScene& scene) {
  System system = scene.system, shown = scene.system;
  if (system[Turntable::kLinearity] == 0) return system;
  shown[Turntable::kLinearity] = 0;
  for (int round = 0; round < kRounds; ++round) {  // the depths that are shown depend on linearity a little
    std::vector<Placement> placements(static_cast<size_t>(scene.placements));
    for (int k = 0; k < scene.placements; ++k) {
      const Plate flat = PlacePlate(scene, k);
      for (int i = 0; i < scene.profiles; ++i) {
        const double alpha = Spread(scene.sweep, i, scene.profiles);
        std::vector<double> y, z;
        for (int j = 0; j < scene.points; ++j) {
          z.push_back(Spread(scene.line_length, j, scene.points));
          y.push_back(ShownDepth(shown, flat, alpha, z.back()));
        }
        placements[static_cast<size_t>(k)].profiles.push_back(CompressProfile(alpha, y, z, {}));
      }
    }
    system.depths = VolumeOf(placements).y;
    shown = system;
  }
  return system;
}

GridBox SearchAround(const System& system, double width_M, double width_N) {
  const double lower_M = std::round(system.M() - 0.65 * width_M),
               lower_N = std::round(system.N() - 14.0 / 30 * width_N);
  return {{lower_M, lower_N}, {lower_M + width_M, lower_N + width_N}, 1};
}

std::vector<SimulatedPlacement> SimulateTurntable(const TurntableScene& scene) {
  std::vector<SimulatedPlacement> placements;
  const System system = WithDepths(scene);
  const double correlation = (scene.line_correlation - 1) / (scene.line_correlation + 1);  // of neighbours, AR(1)
  for (int k = 0; k < scene.placements; ++k) {
    Random random(scene.seed, static_cast<uint64_t>(k) + 1);
    Plate plate = PlacePlate(scene, k);
    plate.form = FormOf(scene, system, k, plate);
    Background background(scene, k);
    SimulatedPlacement& placement = placements.emplace_back();
    placement.name = NameOf(k, scene.placements);
    placement.normal = plate.normal;
    placement.distance = plate.normal.dot(plate.centre);
    for (int i = 0; i < scene.profiles; ++i) {
      const double alpha = Spread(scene.sweep, i, scene.profiles);
      SimulatedProfile& profile = placement.profiles.emplace_back();
      profile.alpha = alpha + scene.encoder_jitter * random.Normal();
      background.NextProfile();
      double noise = random.Normal();
      for (int j = 0; j < scene.points; ++j) {
        const double z = Spread(scene.line_length, j, scene.points);
        if (j > 0) noise = correlation * noise + std::sqrt(1 - correlation * correlation) * random.Normal();
        double y = ShownDepth(system, plate, alpha, z) + background.Behind(j) + scene.noise_y * noise;
        // The same number of draws for every point, so that one kind of error does not shift the others.
        const double spike = random.Uniform(), how_far = random.Uniform(), lost = random.Uniform();
        if (spike < scene.outliers) y += kSpike * (2 * how_far - 1);
        if (lost < scene.missing) y = std::numeric_limits<double>::quiet_NaN();
        profile.y.push_back(y);
        profile.z.push_back(z);
      }
    }
  }
  return placements;
}

}  // namespace scancal

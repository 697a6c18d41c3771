#include "models/turntable/simulate.h"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include "io/units.h"
#include "solver/random.h"

namespace scancal {
namespace {

constexpr double kStandoff = 75;                         // mm from the profiler's zero to the plate, straight ahead
constexpr double kSpike = 30;                            // mm
constexpr double kNearestWall = 30, kFarthestWall = 60;  // mm behind the plate
constexpr double kLeastHalf = 1;                         // mm: of what is seen of a plate by a single profile or point
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
  plate.centre = scene.pose.Point(0, kStandoff, 0);
  plate.across = plate.normal.cross(Eigen::Vector3d::UnitZ()).normalized();
  plate.up = plate.across.cross(plate.normal);
  return plate;
}

// Depth at which the profiler, turned by alpha, sees height z of the plate with its form. Affine in y but for the form,
// whose slope is small, so two steps settle it.
double TrueDepth(const TurntablePose& pose, const Plate& plate, double alpha, double z) {
  const Eigen::Vector3d at_zero = pose.Point(alpha, 0, z), along = pose.Point(alpha, 1, z) - at_zero;
  double y = 0;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d p = at_zero + y * along - plate.centre;
    const double height = k == 0 ? 0 : plate.form.At(plate.across.dot(p), plate.up.dot(p));
    y += (height - plate.normal.dot(p)) / plate.normal.dot(along);
  }
  return y;
}

// From -extent / 2 to extent / 2.
double Spread(double extent, int index, int count) {
  return count == 1 ? 0 : extent * (static_cast<double>(index) / (count - 1) - 0.5);
}

// What the scan sees of the plate, were it flat.
PlateRectangle Seen(const TurntableScene& scene, const Plate& flat) {
  Eigen::AlignedBox2d box;
  for (int i = 0; i < scene.profiles; ++i) {
    for (int j = 0; j < scene.points; ++j) {
      const double alpha = Spread(scene.sweep, i, scene.profiles), z = Spread(scene.line_length, j, scene.points);
      const Eigen::Vector3d p = scene.pose.Point(alpha, TrueDepth(scene.pose, flat, alpha, z), z) - flat.centre;
      box.extend(Eigen::Vector2d(flat.across.dot(p), flat.up.dot(p)));
    }
  }
  const Eigen::Vector2d half = (box.sizes() / 2).cwiseMax(kLeastHalf);
  return {box.center().x(), box.center().y(), half.x(), half.y()};
}

PlateForm FormOf(const TurntableScene& scene, int placement, const Plate& flat) {
  if (scene.form == 0) return {};
  const uint64_t stream = kFormStreams + (scene.one_plate ? 0 : static_cast<uint64_t>(placement));
  return {scene.form_kind, scene.form, Seen(scene, flat), Random(scene.seed, stream)};
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

GridBox SearchAround(const TurntablePose& pose, double width_M, double width_N) {
  const double lower_M = std::round(pose.M - 0.65 * width_M), lower_N = std::round(pose.N - 14.0 / 30 * width_N);
  return {{lower_M, lower_N}, {lower_M + width_M, lower_N + width_N}, 1};
}

std::vector<SimulatedPlacement> SimulateTurntable(const TurntableScene& scene) {
  std::vector<SimulatedPlacement> placements;
  const double correlation = (scene.line_correlation - 1) / (scene.line_correlation + 1);  // of neighbours, AR(1)
  for (int k = 0; k < scene.placements; ++k) {
    Random random(scene.seed, static_cast<uint64_t>(k) + 1);
    Plate plate = PlacePlate(scene, k);
    plate.form = FormOf(scene, k, plate);
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
        double y = TrueDepth(scene.pose, plate, alpha, z) + background.Behind(j) + scene.noise_y * noise;
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

#include "models/turntable/simulate.h"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include "solver/random.h"

namespace scancal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kStandoff = 75;  // mm from the profiler's zero to the plate, straight ahead
constexpr double kSpike = 30;     // mm

// Smooth form of a plate (uncertainty specification, section 2): orthonormal Legendre products of total degree 2 to 4
// over the square [-1, 1]^2, variance falling as degree^-4, scaled to unit rms.
class Form {
 public:
  Form(double rms, Random* random) : rms_(rms) {
    double squares = 0;
    for (unsigned degree = 2; degree <= 4; ++degree) {
      for (unsigned i = 0; i <= degree; ++i) {
        const double amplitude = random->Normal() / std::pow(degree, 2);
        modes_.push_back({i, degree - i, amplitude});
        squares += amplitude * amplitude;
      }
    }
    for (Mode& mode : modes_) mode.amplitude /= std::sqrt(squares);
  }
  double At(double u, double v) const {  // mm along the normal
    if (rms_ == 0) return 0;
    u = std::clamp(u, -1.0, 1.0);
    v = std::clamp(v, -1.0, 1.0);
    double sum = 0;
    for (const Mode& mode : modes_)
      sum += mode.amplitude * std::sqrt((2 * mode.i + 1) * (2 * mode.j + 1)) * std::legendre(mode.i, u) *
             std::legendre(mode.j, v);
    return rms_ * sum;
  }

 private:
  struct Mode {
    unsigned i, j;
    double amplitude;
  };
  double rms_;
  std::vector<Mode> modes_;
};

struct Plate {
  Eigen::Vector3d normal, centre, across, up;
  double half_size;
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
  const double arc = (std::hypot(scene.pose.M, scene.pose.N) + kStandoff) * std::sin(scene.sweep / 2);
  plate.half_size = 1.2 * std::max(arc, scene.line_length / 2);
  return plate;
}

// Depth at which the profiler, turned by alpha, sees height z of the plate with its form. Affine in y but for the form,
// whose slope is small, so two steps settle it.
double TrueDepth(const TurntablePose& pose, const Plate& plate, const Form& form, double alpha, double z) {
  const Eigen::Vector3d at_zero = pose.Point(alpha, 0, z), along = pose.Point(alpha, 1, z) - at_zero;
  double y = 0;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d p = at_zero + y * along - plate.centre;
    const double height =
        k == 0 ? 0 : form.At(plate.across.dot(p) / plate.half_size, plate.up.dot(p) / plate.half_size);
    y += (height - plate.normal.dot(p)) / plate.normal.dot(along);
  }
  return y;
}

}  // namespace

GridBox SearchAround(const TurntablePose& pose, double width_M, double width_N) {
  const double lower_M = std::round(pose.M - 0.65 * width_M), lower_N = std::round(pose.N - 14.0 / 30 * width_N);
  return {{lower_M, lower_N}, {lower_M + width_M, lower_N + width_N}, 1};
}

std::vector<SimulatedPlacement> SimulateTurntable(const TurntableScene& scene) {
  std::vector<SimulatedPlacement> placements;
  Random of_plate(scene.seed, 0);
  const Form form(scene.form, &of_plate);
  const double correlation = (scene.line_correlation - 1) / (scene.line_correlation + 1);  // of neighbours, AR(1)
  for (int k = 0; k < scene.placements; ++k) {
    Random random(scene.seed, static_cast<uint64_t>(k) + 1);
    const Plate plate = PlacePlate(scene, k);
    SimulatedPlacement& placement = placements.emplace_back();
    placement.name = NameOf(k, scene.placements);
    placement.normal = plate.normal;
    placement.distance = plate.normal.dot(plate.centre);
    for (int i = 0; i < scene.profiles; ++i) {
      const double alpha =
          scene.profiles == 1 ? 0 : scene.sweep * (static_cast<double>(i) / (scene.profiles - 1) - 0.5);
      SimulatedProfile& profile = placement.profiles.emplace_back();
      profile.alpha = alpha + scene.encoder_jitter * random.Normal();
      double noise = random.Normal();
      for (int j = 0; j < scene.points; ++j) {
        const double z =
            scene.points == 1 ? 0 : scene.line_length * (static_cast<double>(j) / (scene.points - 1) - 0.5);
        if (j > 0) noise = correlation * noise + std::sqrt(1 - correlation * correlation) * random.Normal();
        double y = TrueDepth(scene.pose, plate, form, alpha, z) + scene.noise_y * noise;
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

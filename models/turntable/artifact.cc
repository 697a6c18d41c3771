#include "models/turntable/artifact.h"
#include <fmt/format.h>
#include <cmath>
#include "io/output_file.h"
#include "io/units.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

constexpr double kBall_mm = 12.7, kStep_mm = 20, kInFront_mm = 100, kSpacing_mm = 1, kProfiles_deg = 0.15;
constexpr double kGrazing = 0.4;  // cosine of incidence

// depth(alpha, z) for each reading of a region; nan: none.
template <class Depth>
SeenTarget See(const Instrument& instrument, const std::string& name, const std::array<double, 2>& alphas,
               const std::array<double, 2>& heights, uint64_t seed, const Depth& depth) {
  SeenTarget target{name, name, {}};
  Random noise(seed, 1), jitter(seed, 2);
  const double correlation = (instrument.line_correlation - 1) / (instrument.line_correlation + 1);  // AR(1)
  for (double alpha = alphas[0]; alpha <= alphas[1]; alpha += kProfiles_deg * kDegree) {
    const double turned = alpha - instrument.encoder_jitter * jitter.Normal();
    double off = noise.Normal();
    for (double z = heights[0]; z <= heights[1]; z += kSpacing_mm) {
      const double y = depth(turned, z) + instrument.noise_y * off;
      off = correlation * off + std::sqrt(1 - correlation * correlation) * noise.Normal();
      if (std::isnan(y)) continue;
      target.points.alpha.push_back(alpha);
      target.points.y.push_back(y);
      target.points.z.push_back(z);
    }
  }
  return target;
}

}  // namespace

SeenTarget SeeBall(const Instrument& instrument, const std::string& name, const Eigen::Vector3d& centre, double radius,
                   uint64_t seed) {
  const System& system = instrument.system;
  const double alpha = std::atan2(-system.N() - kInFront_mm, system.M()) - std::atan2(centre.y(), centre.x());
  const double half = 1.2 * radius / centre.head<2>().norm();
  return See(instrument, name, {alpha - half, alpha + half}, {centre.z() - radius, centre.z() + radius}, seed,
             [&](double turned, double z) {
               const Eigen::Vector3d from = system.Point(turned, 0, z) - centre,
                                     along = system.Point(turned, 1, z) - system.Point(turned, 0, z);
               const double middle = -from.dot(along) / along.squaredNorm();
               const double under = middle * middle - (from.squaredNorm() - radius * radius) / along.squaredNorm();
               return under > std::pow(kGrazing * radius, 2) ? middle - std::sqrt(under) : std::nan("");
             });
}

SeenTarget SeePlane(const Instrument& instrument, const std::string& name, const Eigen::Vector3d& normal,
                    double distance, const std::array<double, 2>& alphas, const std::array<double, 2>& heights,
                    uint64_t seed) {
  return See(instrument, name, alphas, heights, seed, [&](double turned, double z) {
    const Eigen::Vector3d from = instrument.system.Point(turned, 0, z);
    return (distance - normal.dot(from)) / normal.dot(instrument.system.Point(turned, 1, z) - from);
  });
}

Artifact SeeArtifact(const Instrument& instrument, double u_reference, uint64_t seed) {
  Random random(seed, 0);
  const auto true_size = [&](double nominal) { return nominal + u_reference * random.Normal(); };
  const auto at = [&](double alpha_deg, double z) {
    return instrument.system.Point(alpha_deg * kDegree, kInFront_mm, z);
  };
  const Eigen::Vector3d a = at(-9, -60), b = at(9, 50), n = Eigen::Vector3d(0.1, -1, 0.2).normalized();
  const double apart = std::round((b - a).norm() * 1000) / 1000, distance = n.dot(at(0, 0));
  const double radius = true_size(2 * kBall_mm) / 2;
  const auto plane = [&](const char* name, double offset, double from_deg, uint64_t stream) {
    return SeePlane(instrument, name, n, offset, {from_deg * kDegree, (from_deg + 4) * kDegree}, {-20, 20},
                    10 * seed + stream);
  };
  Artifact artifact;
  artifact.targets = {SeeBall(instrument, "A", a, radius, 10 * seed + 1),
                      SeeBall(instrument, "B", a + true_size(apart) * (b - a).normalized(), radius, 10 * seed + 2),
                      plane("top", distance, -5, 3), plane("ground", distance - true_size(kStep_mm), 1, 4)};
  artifact.features = {{"ball", "", Feature::Kind::kDiameter, {0}, 2 * kBall_mm, u_reference, {}},
                       {"bar", "", Feature::Kind::kDistance, {0, 1}, apart, u_reference, {}},
                       {"step", "", Feature::Kind::kStep, {3, 2}, kStep_mm, u_reference, {}}};
  return artifact;
}

Result<void> WriteArtifact(const Scene& scene, const std::filesystem::path& folder) {
  constexpr double kReference_mm = 0.002;
  const Artifact artifact = SeeArtifact(
      {WithDepths(scene), scene.noise_y, scene.encoder_jitter, scene.line_correlation}, kReference_mm, scene.seed);
  std::string yaml =
      "scancal: 1\nmodel: turntable\nname: simulated artifact, a ball bar and a step\n"
      "units: {length: mm, angle: deg}\nrotation: clockwise\ntargets:\n";
  for (const SeenTarget& target : artifact.targets) {
    yaml += fmt::format("  - {{name: {0}, scan: {0}.csv}}\n", target.name);
    std::string text = "angle,y,z\n";
    for (size_t i = 0; i < target.points.y.size(); ++i)
      text += fmt::format("{:.6f},{:.4f},{:.4f}\n", target.points.alpha[i] / kDegree, target.points.y[i],
                          target.points.z[i]);
    SCANCAL_RETURN_IF_ERROR(WriteFile(folder / (target.name + ".csv"), text));
  }
  yaml += "features:\n";
  const auto line = [&](size_t k, const std::string& of) {
    yaml += fmt::format("  - {{name: {}, {}, nominal: {:.3f}, U: {}, tolerance: 0.3}}\n", artifact.features[k].name, of,
                        artifact.features[k].nominal, 2 * kReference_mm);
  };
  line(0, "diameter: A");
  line(1, "distance: [A, B]");
  line(2, "step: [ground, top]");
  return WriteFile(folder / "verify.yaml", yaml);
}

}  // namespace scancal::turntable

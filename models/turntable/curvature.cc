// What bends all profiles alike moves no line, but often M and N: errors of the lens, and the form of a plate.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include "models/turntable/scanner.h"
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/gum.h"

namespace scancal::turntable {
namespace {

constexpr Message<double, double, double, std::string_view, double, double> kBentProfiles{
    "turntable.bent_profiles",
    "the profiles are bent: as if depth grew by {:.2g} zeta^2 {:+.2g} eta zeta^2 mm along the line (F = {:.3g}), zeta "
    "from -1 "
    "to 1 over the line, eta over the depths. If that is the lens (lens_z2, lens_yz2), {} is wrong by {:+.2g} mm "
    "({:.2g} u); it "
    "may as well be the form of the plate. Declare lens_z2 and lens_yz2, or form",
    "Die Profile sind gekrümmt, als wüchse die Tiefe längs der Linie um {:.2g} zeta^2 {:+.2g} eta zeta^2 mm (F = "
    "{:.3g}), "
    "zeta von -1 bis 1 über die Linie, eta über die Tiefen. Ist das die Optik (lens_z2, lens_yz2), so ist {} um "
    "{:+.2g} mm "
    "falsch ({:.2g} u); es kann auch die Form der Platte sein. lens_z2 und lens_yz2 oder form angeben"};

constexpr double kSignificant = 1e-4;
constexpr double kFewest = 12;  // profiles

struct Bent {
  double c = 0, eta = 0, weight = 0;  // of zeta^2 in a profile, mm; its depth; sum of squares of the shape
};

// By least squares over the segments, beside the profile's own line.
Bent BentOf(const Profile& profile, const System& system) {
  constexpr int kTerms = 3;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  const double mean = profile.factor(0, 2) / profile.factor(0, 0);
  const double half = std::max(1e-9, (system.heights[1] - system.heights[0]) / 2),
               middle = (system.heights[1] + system.heights[0]) / 2;
  for (const ProfileFactor& segment : profile.segments) {
    const double n = segment(0, 0) * segment(0, 0), z = (segment(0, 1) / segment(0, 0) - middle) / half;
    const double square = z * z + std::pow(segment(1, 1) / segment(0, 0) / half, 2);
    const Eigen::Vector3d terms(1, z, square);
    normal += n * terms * terms.transpose();
    right += n * terms * (segment(0, 2) / segment(0, 0) - mean);
  }
  if (std::ssize(profile.segments) <= kTerms) return {};
  const Eigen::Matrix3d inverse = normal.inverse();
  const double weight = 1 / inverse(2, 2);
  if (!(weight > 1e-6 * normal(2, 2))) return {};
  const double eta =
      (2 * mean - system.depths[0] - system.depths[1]) / std::max(1e-9, system.depths[1] - system.depths[0]);
  return {inverse.row(2).dot(right), eta, weight};
}

}  // namespace

void JudgeCurvature(const std::vector<Placement>& placements, const JointFit& fit, Calibration* calibration) {
  const Problem& problem = fit.solution.problem;
  for (const int k : {Model::kLensZ2, Model::kLensYZ2, Model::kForm, Model::kLinearity3})
    if (problem.quantities[k].role == Role::kEstimate) return;
  const System found = fit.Found();
  std::vector<Bent> bent;
  for (const Placement& placement : placements) {
    if (placement.IsLidar()) return;  // along the range a line is no line
    for (const Profile& profile : placement.profiles)
      if (const Bent each = BentOf(profile, found); each.weight > 0) bent.push_back(each);
  }
  if (static_cast<double>(bent.size()) < kFewest) return;
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Bent& each : bent) {
    const Eigen::Vector2d terms(1, each.eta);
    normal += each.weight * terms * terms.transpose();
    right += each.weight * each.c * terms;
  }
  const Eigen::Matrix2d inverse = normal.inverse();
  const Eigen::Vector2d lens = inverse * right;
  // What the profiles scatter by, not the noise of points: that may be correlated along the line. And between
  // neighbours.
  double squares = 0, products = 0, before = 0;
  for (const Bent& each : bent) {
    const double left = std::sqrt(each.weight) * (each.c - lens[0] - lens[1] * each.eta);
    squares += left * left;
    products += left * before;
    before = left;
  }
  const double rho = std::clamp(squares > 0 ? products / squares : 0.0, 0.0, 0.95);
  const double dof = static_cast<double>(bent.size()) - 2;
  Eigen::Matrix2d covariance = inverse * (squares / dof) * (1 + rho) / (1 - rho);
  for (const int k : {0, 1}) {
    const Quantity& declared = problem.quantities[k == 0 ? Model::kLensZ2 : Model::kLensYZ2];
    if (declared.role == Role::kConsider) covariance(k, k) += declared.u * declared.u;
  }
  // The first modes of a plate are bent by about 1.7 of its form, anew in every placement.
  if (const Quantity& form = problem.quantities[Model::kForm]; form.role == Role::kConsider)
    covariance += inverse * normal(0, 0) * std::pow(1.7 * form.u, 2) / static_cast<double>(placements.size()) * 2;
  const double F = lens.dot(covariance.inverse() * lens) / 2;
  if (!(FUpperTail(F, 2, dof * (1 - rho) / (1 + rho)) < kSignificant)) return;
  const std::vector<int> lenses = {Model::kLensZ2, Model::kLensYZ2};
  const std::vector<double> wrong = Plain(  // depth as shown lacks it
      SensitivitiesTo(problem, fit.solution.fit.estimate, fit.solution.linear, lenses) * lens);
  const auto [which, furthest] = Furthest(wrong, *calibration);
  if (!(furthest > 1)) return;
  const auto e =
      std::find(calibration->estimated.begin(), calibration->estimated.end(), which) - calibration->estimated.begin();
  calibration->unreliable.push_back(
      Say(kBentProfiles, lens[0], lens[1], F, which, wrong[static_cast<size_t>(e)], furthest));
}

}  // namespace scancal::turntable

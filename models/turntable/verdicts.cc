#include "models/turntable/verdicts.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "io/units.h"

namespace scancal {

using turntable::System;

namespace {

constexpr double kPerpendicular = 1 * kDegree;  // a plate's normal nearer to the axis tells nothing of M and N
constexpr double kApart = 5 * kDegree;          // two placements are different
constexpr double kNarrowSweep = 5 * kDegree;
constexpr double kFarFromGrid = 5;  // of step and u
constexpr double kEdgeOn = 0.02;    // cosine of the incidence

// Smallest |n . d| over the profiles of a placement, d the direction along which the sensor measures.
double LeastIncidence(const Placement& placement, const System& system, const Eigen::Vector3d& normal) {
  double least = 1;
  for (const Profile& profile : placement.profiles) {
    const PseudoPoint p = PseudoPoints(profile.factor)[1];
    const turntable::ProfileInTable<double> in_table = system.At(profile.alpha);
    const auto along = [&](double y, double z) {
      return Eigen::Vector3d(Eigen::Vector3d::Map(in_table.Point(y, z, 0).data()) -
                             Eigen::Vector3d::Map(in_table.Point(0, 0, 0).data()));
    };
    const Eigen::Vector3d towards = placement.IsLidar() ? along(p.y, p.z) : along(1, 0);
    least = std::min(least, std::abs(normal.dot(towards.normalized())));
  }
  return least;
}

// Largest angle between two normals, their signs aside.
double LargestAngle(const TurntableFit& fit) {
  double largest = 0;
  for (size_t i = 0; i < fit.targets.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      largest = std::max(largest, std::acos(std::min(1.0, std::abs(fit.Plane(i).first.dot(fit.Plane(j).first)))));
  return largest;
}

const Parameter* LeastKnownLength(const Calibration& calibration) {
  const Parameter* worst = nullptr;
  for (const Parameter& p : calibration.parameters)
    if (p.role == Role::kEstimate && p.unit == Unit::kMm && (!worst || p.u > worst->u)) worst = &p;
  return worst;
}

void JudgeOrientations(const TurntableFit& fit, Calibration* calibration) {
  const double angle = LargestAngle(fit);
  const Parameter* worst = LeastKnownLength(*calibration);
  if (angle >= kApart || !worst) return;
  const std::string which = fit.targets.size() == 1
                                ? "there is only one placement of the plate"
                                : fmt::format("the normals of all placements lie within {:.2g} deg", angle / kDegree);
  calibration->unreliable.push_back(
      which + "; " + worst->name + fmt::format(" suffers most (u = {:.2g} mm); ", worst->u) +
      "add a placement with the plate turned about the vertical by 20 deg or more against the others");
}

void JudgeSearch(const GridBox& box, const GridNode& least, Calibration* calibration) {
  if (least.on_edge)
    calibration->unreliable.push_back(
        fmt::format("the grid minimum M = {:g}, N = {:g} mm lies on the edge of the search interval; "
                    "widen search in dataset.yaml",
                    least.at[0], least.at[1]));
  for (const size_t k : {0, 1}) {
    const Parameter* p = calibration->Find(k == 0 ? "M" : "N");
    const double apart = std::abs(p->value - least.at[k]);
    if (p->role == Role::kEstimate && !least.on_edge && apart > kFarFromGrid * (box.step + p->u))
      calibration->unreliable.push_back(
          fmt::format("{}: the grid minimum lies {:.3g} mm from the refined value, more than step and u explain: the "
                      "noise pulls the "
                      "search away, or the model lacks something",
                      p->name, apart));
    if (p->role == Role::kEstimate && (p->value < box.lower[k] || p->value > box.upper[k]) && !least.on_edge)
      calibration->unreliable.push_back(fmt::format(
          "{} = {:.6g} mm lies outside the search interval; widen search in dataset.yaml, or look at the scans",
          p->name, p->value));
  }
}

}  // namespace

Result<void> CheckOrientations(const Quantities& quantities, const std::vector<Placement>& placements,
                               const std::vector<PlaneStorey>& storeys, const System& system) {
  bool all_perpendicular = true;
  for (size_t t = 0; t < placements.size(); ++t) {
    const Eigen::Vector3d normal = storeys[t].FitPlane(system.M(), system.N()).first;
    all_perpendicular &= std::abs(normal.z()) > std::cos(kPerpendicular);
  }
  std::vector<std::string> names;
  for (const int k : {Turntable::kM, Turntable::kN})
    if (quantities[k].role == Role::kEstimate && quantities[k].u <= 0) names.push_back(quantities[k].name);
  if (all_perpendicular && !names.empty())
    return Error{Listed(names) +
                 ": not determined: every plate is perpendicular to the axis, and such a plane looks the same "
                 "for every offset; stand the plate up, 5 to 20 deg from the axis"};
  return {};
}

Result<void> CheckIncidence(const std::vector<Placement>& placements, const System& system) {
  for (const Placement& placement : placements) {
    const Eigen::Vector3d normal = PlaneStorey(placement.profiles, system).FitPlane(system.M(), system.N()).first;
    if (LeastIncidence(placement, system, normal) < kEdgeOn)
      return Error{
          "target " + placement.name +
          ": the sensor sees the plate edge-on, where depth tells nothing; narrow its keep: angle, or leave it out"};
  }
  return {};
}

Result<void> CheckDetermined(const TurntableFit& fit) {
  const Observability& seen = fit.solution.observability;
  if (!seen.undetermined_targets.empty())
    return Error{"target " + Listed(seen.undetermined_targets) +
                 ": its plane is not determined; it needs profiles at two angles or more"};
  if (!seen.undetermined.empty())
    return Error{Listed(seen.undetermined) + ": not determined by these placements; hold " +
                 (seen.undetermined.size() == 1 ? "it" : "one of them") + " or give a prior, {estimate: 0, u: ...}"};
  return {};
}

void JudgeTurntable(const GridBox& box, const std::vector<Placement>& placements, const GridResult& grid,
                    const TurntableFit& fit, Calibration* calibration) {
  JudgeSearch(box, grid.best, calibration);
  JudgeOrientations(fit, calibration);
  double widest = 0;
  for (const Placement& placement : placements) widest = std::max(widest, placement.Sweep());
  if (widest < kNarrowSweep)
    calibration->warnings.push_back(
        fmt::format("the sweep of {:.2g} deg is too narrow to tell M and N well: a wider one is the cheapest gain; if "
                    "the file holds "
                    "radians, declare angle: rad",
                    widest / kDegree));
}

}  // namespace scancal

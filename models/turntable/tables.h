// The tables of a result that its figures are drawn from.
#pragma once
#include <vector>
#include "models/turntable/use.h"

namespace scancal::turntable {

// A placement with the values that a fit found, one per quantity.
struct FittedPlacement {
  const Placement& placement;
  const Model::Target& target;
  const std::vector<double>& values;
  const System& system;  // what it found of the system
};

// Mean depth residuals (measured minus predicted; of a lidar along the range), mm, whatever residual was made small:
//
//     "cells"              alpha_from, alpha_to, z_from, z_to, residual, points: neighbouring profiles, at most 120
//                          groups of them, by as many intervals of z as a profile has segments; those without points
//                          are left out
//     "sweep"              alpha, residual, u: of each profile, at most 600 groups of them; u as the noise within
//                          profiles explains it
//     "sweep_correlation"  lag, correlation: of the profiles' means, lag in profiles
//
// in the order of alpha. Within a segment the residual is affine: its mean is that at the mean of the points, exactly
// (a lidar's to first order).
NumberTables ResidualTables(const FittedPlacement& fitted);

// The residuals of all points from the line of their own profile.
ViewResiduals ResidualsOf(const Placement& placement);

// Of a target, in the table frame: "outline", closed (the last corner is the first), the patch that was measured, its
// corners on the plane that was found (normal, distance); "views", of at most nine profiles evenly over the sweep, from
// the profiler's origin to the middle of what it saw. Everything else of the calibration must be in place.
void AddScene(const std::vector<Placement>& placements, Calibration* calibration);

}  // namespace scancal::turntable

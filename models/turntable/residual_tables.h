// Where on the target and in the sweep the residuals of a turntable's fit lie.
#pragma once
#include <vector>
#include "models/turntable/placement.h"
#include "models/turntable/volume.h"

namespace scancal {

// A placement with the values that a fit found, one per quantity.
struct FittedPlacement {
  const Placement& placement;
  const Turntable::Target& target;
  const std::vector<double>& values;
  const turntable::System& system;  // what it found of the system
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

}  // namespace scancal

// What a calibration says of a robot's parameters.
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/parts/chain.h"
#include "solver/calibration.h"

namespace scancal {

// In this order. An Error names a parameter that the calibration does not have.
Result<Eigen::VectorXd> ValuesOf(const Calibration& calibration, const std::vector<std::string>& names);

// theta_1 .. beta_n of all links. An Error also where the calibration has more links than these.
Result<std::vector<Link>> LinkErrorsOf(const Calibration& calibration, size_t links);

}  // namespace scancal

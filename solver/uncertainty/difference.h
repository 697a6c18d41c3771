// Several calibrations of one instrument: what changed between them, and how well that is known.
#pragma once
#include <Eigen/Core>
#include <set>
#include <span>
#include <string>
#include <vector>
#include "solver/uncertainty/measurand.h"

namespace scancal {

// The parameters that all of them have estimated, in the order of the first. An orientation (what_rx, _ry, _rz) counts
// as a whole: its change is the rotation R R_1' from the first, as a vector about the axes of the frame that it turns
// into, to which the covariance of a rotation vector v is taken by d(rotation) = J(v) dv, J = 1 + (1 - cos t) / t^2
// [v]x + (t - sin t) / t^3 [v]x^2, t = |v| (Sola, Deray, Atchuthan, A micro Lie theory, 2018, eq. (145)). First order:
// for changes that are small against a rad. Vectors near half a turn on either side are neighbours.
struct Series {
  std::vector<std::string> names;
  std::vector<Unit> units;
  Eigen::VectorXd start;   // values of the first; 0 of an orientation
  Eigen::MatrixXd change;  // names x calibrations: less the first
  // Estimates of all calibrations, one after the other, then what was considered in any.
  JointCovariance joint;
  std::vector<Eigen::MatrixXd> by;  // per calibration: d change / d joint, as if the first were exact; names x joint
  std::vector<std::string> shared;  // considered in several, one and the same error in all of them
};

// anew: what is considered under these names is another error in each calibration. Every other considered quantity is
// one error; where its u differs, the larger counts in all. all: at least one.
Series SeriesOf(std::span<const Calibration> all, const std::set<std::string>& anew);

// E_n = difference / U(difference) (ISO 13528, 9.7): at most 1 in size where two values agree within what is known of
// them at 95 %. nan without an uncertainty.
double NormalizedError(double difference, double U);

struct ParameterChange {
  std::string name;
  Unit unit = Unit::kOne;
  double change = 0, u = 0, U = 0, E_n = 0;
};

struct CalibrationDifference {
  std::vector<ParameterChange> changes;
  std::vector<std::string> shared;
  // d' C^-1 d of all changes d with their covariance C, n of them; p of F = chi_squared / n with n and dof degrees of
  // freedom (JCGM 102, 6.5.2), of chi-squared where dof is infinite. n = 0: none in common.
  double chi_squared = 0, n = 0, dof = 0, p = 1;
  bool significant() const;  // p < 1 - kCoverage
};

// Of the last calibration against the first.
CalibrationDifference DifferenceOf(const Series& series);

}  // namespace scancal

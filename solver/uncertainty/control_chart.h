// Control charts: whether an instrument stays what it was, from calibration to calibration.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "solver/uncertainty/difference.h"

namespace scancal {

// What is still taken for chance. Of one chart the limits of Shewhart, 3 u (ISO 7870-2), and the decision interval h =
// 5 u with the reference k = 0.5 u of a CUSUM (Montgomery, Introduction to Statistical Quality Control, 2013, 9.1). Of
// n charts side by side the false alarms together are to be as rare as of one: the limit is that of a probability of
// 0.0027 / n, and h grows by ln n, since the run length grows as exp(h) (Siegmund, Sequential Analysis, 1985, 2.5).
struct ChartLimits {
  double k = 3, h = 5;
};
inline constexpr double kCusumSlack = 0.5;  // u
ChartLimits LimitsOf(size_t charts);

struct ChartPoint {
  double value = 0, u = 0, U = 0;  // of the calibration
  double low = 0, high = 0;        // limits about the centre, of what is not common to all
  double deviation = 0;            // from the centre, in u of it
  double up = 0, down = 0;         // CUSUM of the deviations beyond kCusumSlack, either way, never below 0
  bool beyond = false, alarm = false;
};

struct ControlChart {
  std::string name;
  Unit unit = Unit::kOne;
  double centre = 0, u_centre = 0;  // mean by generalised least squares
  double slope = 0, u_slope = 0;    // of a straight line through the values, per unit of time; 0 of less than three
  double chi_squared = 0, p = 1;    // of the deviations from the mean, with n - 1 degrees of freedom
  bool drifts = false;              // |slope| > k u_slope
  std::vector<ChartPoint> points;
  bool quiet() const;  // nothing of all that
};

// One per parameter that all have estimated, from two calibrations on. Values y of one parameter with their covariance
// C, which holds what was considered in several of them (SeriesOf): mean (1'C^-1 1)^-1 1'C^-1 y, and the line likewise
// (GUM, JCGM 102, 6.2); a deviation from the mean has the variance C_ii - u(mean)^2, in which what is common to all
// cancels. times: increasing, one a calibration.
std::vector<ControlChart> ChartsOf(const Series& series, std::span<const double> times);

}  // namespace scancal

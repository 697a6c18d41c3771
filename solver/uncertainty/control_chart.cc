#include "solver/uncertainty/control_chart.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"

namespace scancal {
namespace {

constexpr double kBeyondThreeSigma = 0.0027;

Eigen::MatrixXd InverseOf(const Eigen::MatrixXd& covariance) {
  constexpr double kNothing = 1e-14;  // of the largest eigenvalue: exact
  const SymmetricEigen of = EigenOf(covariance);
  const double least = kNothing * of.values.maxCoeff();
  return of.vectors * of.values.cwiseMax(least).cwiseInverse().asDiagonal() * of.vectors.transpose();
}

ControlChart ChartOf(const Eigen::VectorXd& y, const Eigen::MatrixXd& covariance, const Eigen::VectorXd& t,
                     const ChartLimits& limits) {
  ControlChart chart;
  const auto n = y.size();
  const Eigen::MatrixXd weights = InverseOf(covariance);
  const Eigen::VectorXd of_mean = weights.rowwise().sum();
  chart.u_centre = 1 / std::sqrt(of_mean.sum());
  chart.centre = of_mean.dot(y) / of_mean.sum();
  const Eigen::VectorXd off = y.array() - chart.centre;
  chart.chi_squared = off.dot(weights * off);
  chart.p = FUpperTail(chart.chi_squared / static_cast<double>(n - 1), static_cast<double>(n - 1), kInfinity);
  if (n > 2) {
    const Eigen::VectorXd from_middle = t.array() - of_mean.dot(t) / of_mean.sum();  // then independent of the mean
    const Eigen::VectorXd of_slope = weights * from_middle;
    const double information = of_slope.dot(from_middle);
    chart.slope = of_slope.dot(off) / information;
    chart.u_slope = 1 / std::sqrt(information);
    chart.drifts = std::abs(chart.slope) > limits.k * chart.u_slope;
  }
  double up = 0, down = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    ChartPoint& point = chart.points.emplace_back();
    const double u = std::sqrt(std::max(0.0, covariance(i, i) - chart.u_centre * chart.u_centre));
    point.value = y[i];
    point.u = std::sqrt(covariance(i, i));
    point.low = chart.centre - limits.k * u;
    point.high = chart.centre + limits.k * u;
    point.deviation = u > 0 ? off[i] / u : 0;
    point.up = up = std::max(0.0, up + point.deviation - kCusumSlack);
    point.down = down = std::max(0.0, down - point.deviation - kCusumSlack);
    point.beyond = std::abs(point.deviation) > limits.k;
    point.alarm = std::max(up, down) > limits.h;
  }
  return chart;
}

}  // namespace

ChartLimits LimitsOf(size_t charts) {
  const double n = std::max<double>(1, static_cast<double>(charts));
  return {CoverageFactor(1 - kBeyondThreeSigma / n, kInfinity), 5 + std::log(n)};
}

bool ControlChart::quiet() const {
  return !drifts && std::none_of(points.begin(), points.end(), [](const auto& p) { return p.beyond || p.alarm; });
}

std::vector<ControlChart> ChartsOf(const Series& series, std::span<const double> times) {
  const auto n = std::ssize(series.by);
  CHECK_GE(n, 2);
  CHECK_EQ(std::ssize(times), n);
  const Eigen::VectorXd t = Eigen::VectorXd::Map(times.data(), n);
  const ChartLimits limits = LimitsOf(series.names.size());
  std::vector<ControlChart> charts;
  for (Eigen::Index k = 0; k < std::ssize(series.names); ++k) {
    Eigen::MatrixXd by(n, series.joint.matrix.cols());
    for (Eigen::Index i = 0; i < n; ++i) by.row(i) = series.by[i].row(k);
    ControlChart& chart =
        charts.emplace_back(ChartOf(series.change.row(k), by * series.joint.matrix * by.transpose(), t, limits));
    chart.name = series.names[k];
    chart.unit = series.units[k];
    chart.centre += series.start[k];
    for (Eigen::Index i = 0; i < n; ++i) {
      ChartPoint& point = chart.points[i];
      for (double* number : {&point.value, &point.low, &point.high}) *number += series.start[k];
      point.U = UncertaintyOf(series.joint, by.row(i)).U[0];
    }
  }
  return charts;
}

}  // namespace scancal

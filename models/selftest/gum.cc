// The worked examples of the GUM (JCGM 100:2008, Annex H).
#include "solver/uncertainty/gum.h"
#include <cmath>
#include "models/selftest/fit.h"
#include "models/selftest/selftest.h"

namespace scancal::selftest {
namespace {

struct Input {
  double x, u, dof;
};

double Rectangular(double half_width) { return half_width / std::sqrt(3.0); }  // GUM 4.3.7
double Arcsine(double half_width) { return half_width / std::sqrt(2.0); }      // of a cyclic variation, GUM H.1.3.4

}  // namespace

SelftestRow CheckGaugeBlock() {
  enum { kStandard, kRepeated, kRandom, kSystematic, kExpansion, kExpansions, kTemperatures, kMean, kCycle, kInputs };
  const Input inputs[kInputs] = {{50000623, 75 / 3.0, 18},                 // length of the standard, nm
                                 {215, 13 / std::sqrt(5), 24},             // mean difference of five readings, nm
                                 {0, 10 / CoverageFactor(0.95, 5), 5},     // comparator, random, nm
                                 {0, 20 / 3.0, 8},                         // comparator, systematic, nm
                                 {11.5e-6, Rectangular(2e-6), kInfinity},  // expansion of the standard, 1/K
                                 {0, Rectangular(1e-6), 50},               // difference of the expansions, 1/K
                                 {0, Rectangular(0.05), 2},                // difference of the temperatures, K
                                 {-0.1, 0.2, kInfinity},                   // mean temperature of the bed less 20, K
                                 {0, Arcsine(0.5), kInfinity}};            // its cycle, K
  Eigen::Vector<double, kInputs> x, u;
  std::vector<double> dofs;
  for (int k = 0; k < kInputs; ++k) {
    x[k] = inputs[k].x;
    u[k] = inputs[k].u;
    dofs.push_back(inputs[k].dof);
  }
  const auto length = Evaluate<1, kInputs>(
      [](const auto* q, auto* l) {  // eq. H.3
        const auto theta = q[kMean] + q[kCycle];
        *l = q[kStandard] + q[kRepeated] + q[kRandom] + q[kSystematic] -
             q[kStandard] * (q[kExpansions] * theta + q[kExpansion] * q[kTemperatures]);
      },
      x);
  const Eigen::VectorXd budget = length.sensitivity.transpose().cwiseAbs().cwiseProduct(u);
  const Eigen::Matrix<double, kInputs, kInputs> variances = u.cwiseAbs2().asDiagonal();
  const double u_length = std::sqrt(PropagateCovariance(length.sensitivity, variances)(0, 0));
  const std::span<const double> parts(budget.data(), kInputs);
  const double dof = EffectiveDof(parts, dofs);
  const double dof_comparison = EffectiveDof(parts.subspan(kRepeated, 3), std::span(dofs).subspan(kRepeated, 3));
  return {.name = "GUM H.1, gauge block",
          .values = Compare(Eigen::Vector4d(length.y[0], dof_comparison, dof, CoverageFactor(0.99, std::floor(dof))),
                            {"50000838", "25.6", "16.7", "2.92"}, kAllDigits),
          .deviations = Compare(Eigen::Vector<double, 5>(budget[kStandard], budget.segment<3>(kRepeated).norm(),
                                                         budget[kExpansions], budget[kTemperatures], u_length),
                                {"25", "9.7", "2.9", "16.6", "32"}, kAllDigits)};
}

SelftestRow CheckImpedance() {
  constexpr int kReadings = 5;
  Eigen::Matrix<double, 3, kReadings> readings;   // table H.2: V/V, I/mA, phi/rad
  readings << 5.007, 4.994, 5.005, 4.990, 4.999,  //
      19.663, 19.639, 19.640, 19.685, 19.678,     //
      1.0456, 1.0438, 1.0468, 1.0428, 1.0433;
  const Eigen::Vector3d mean = readings.rowwise().mean();
  const Eigen::Matrix<double, 3, kReadings> off = readings.colwise() - mean;
  const Eigen::Matrix3d of_means = off * off.transpose() / (kReadings * (kReadings - 1));  // eq. 17
  const auto impedance = Evaluate<3, 3>(
      [](const auto* q, auto* y) {  // R, X, Z of eq. H.7, ohm
        y[2] = q[0] / (q[1] * 1e-3);
        y[0] = y[2] * cos(q[2]);
        y[1] = y[2] * sin(q[2]);
      },
      mean);
  const Eigen::Matrix3d covariance = PropagateCovariance(impedance.sensitivity, of_means);
  const Eigen::Matrix3d r = Correlations(covariance);
  Eigen::Vector<double, 6> deviations;
  deviations << covariance.diagonal().cwiseSqrt(), r(0, 1), r(0, 2), r(1, 2);
  return {.name = "GUM H.2, impedance",
          .observations = 3 * kReadings,
          .parameters = 3,
          .values = Compare(impedance.y, {"127.732", "219.847", "254.260"}, kAllDigits),
          .deviations = Compare(deviations, {"0.071", "0.295", "0.236", "-0.588", "-0.485", "0.993"}, kAllDigits)};
}

SelftestRow CheckThermometer() {
  const double readings[] = {21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511};
  const double corrections[] = {-0.171, -0.169, -0.166, -0.159, -0.164, -0.165,
                                -0.156, -0.157, -0.159, -0.161, -0.160};  // table H.6, degrees Celsius
  std::vector<Observation> observations;
  for (size_t k = 0; k < std::size(readings); ++k) observations.push_back({corrections[k], {readings[k] - 20, 0}});
  const auto line = [](const auto* b, const double* x) { return b[0] + b[1] * x[0]; };
  const LeastSquares solved = SolveLeastSquares(PoseRegression<decltype(line)>({0, 0}, observations));
  const Eigen::Vector2d b = solved.fit.estimate.system;
  const Eigen::RowVector2d at_30(1, 10);
  const Eigen::Matrix2d& covariance = solved.covariance.matrix;
  return {.name = "GUM H.3, thermometer",
          .observations = static_cast<int>(observations.size()),
          .parameters = 2,
          .values = Compare(Eigen::Vector3d(b[0], b[1], at_30 * b), {"-0.1712", "0.00218", "-0.1494"}, kAllDigits),
          .deviations = Compare(Eigen::Vector<double, 5>(std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)),
                                                         Correlations(covariance)(0, 1),
                                                         std::sqrt(solved.fit.cost / solved.covariance.dof),
                                                         std::sqrt(PropagateCovariance(at_30, covariance)(0, 0))),
                                {"0.0029", "0.00067", "-0.930", "0.0035", "0.0041"}, kAllDigits),
          .iterations = solved.fit.iterations,
          .note = solved.fit.message};
}

}  // namespace scancal::selftest

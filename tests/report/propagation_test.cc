#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include "io/units.h"
#include "report/text.h"

namespace scancal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

MeasurandUncertainty Uncertainty(const Eigen::MatrixXd& covariance) {
  MeasurandUncertainty uncertainty;
  uncertainty.covariance = covariance;
  uncertainty.dof = 20.7;
  uncertainty.k = 2.086;
  uncertainty.U = 2.086 * covariance.diagonal().cwiseSqrt();
  uncertainty.U_max = 0.5;
  return uncertainty;
}

Propagation SomePropagation() {
  Propagation propagation;
  propagation.reading = {"alpha", "y"};
  propagation.units = {Unit::kRad, Unit::kMm};
  const Eigen::Matrix3d covariance{{0.01, -0.002, 0}, {-0.002, 0.04, 0.003}, {0, 0.003, 0}};
  propagation.points = {{{10 * kDegree, 50}, {100.5, -300.25, 7}, Uncertainty(covariance)},
                        {{-M_PI / 2, 60}, {110.5, -310.25, 7}, Uncertainty(4 * covariance)}};
  propagation.distances = {{0, 1, 14.125, Uncertainty(Eigen::MatrixXd::Constant(1, 1, 0.0025))}};
  propagation.notes = {"a note"};
  return propagation;
}

TEST(PropagationText, ShowsPointsDistancesAndNotes) {
  const std::string text = ToText(SomePropagation());
  EXPECT_THAT(text, AllOf(HasSubstr("alpha/deg"), HasSubstr("10.0000"), HasSubstr("-90.0000"), HasSubstr("100.50(10)"),
                          HasSubstr("-300.25(20)"), HasSubstr("0.21"), HasSubstr("0.42"), HasSubstr("2.09"),
                          HasSubstr("  20\n")));
  EXPECT_THAT(text, AllOf(HasSubstr("1 to 2"), HasSubstr("14.125(50)"), HasSubstr("\na note\n")));
  Propagation points_only = SomePropagation();
  points_only.distances.clear();
  EXPECT_THAT(ToText(points_only), Not(HasSubstr("distance")));
}

TEST(PropagationCsv, HoldsTheCovariance) {
  EXPECT_EQ(
      ToCsv(SomePropagation()),
      "alpha_deg,y_mm,X_mm,Y_mm,Z_mm,u_X_mm,u_Y_mm,u_Z_mm,cov_XY_mm2,cov_XZ_mm2,cov_YZ_mm2,U_X_mm,U_Y_mm,U_Z_mm,"
      "U_max_mm,k,dof,distance_mm,u_distance_mm,U_distance_mm,k_distance,dof_distance\n"
      "10,50,100.5,-300.25,7,0.1,0.2,0,-0.002,0,0.003,0.2086,0.4172,0,0.5,2.086,20.7,,,,,\n"
      "-90,60,110.5,-310.25,7,0.2,0.4,0,-0.008,0,0.012,0.4172,0.8344,0,0.5,2.086,20.7,14.125,0.05,0.5,2.086,20.7\n");
  Propagation points_only = SomePropagation();
  points_only.distances.clear();
  EXPECT_THAT(ToCsv(points_only), Not(HasSubstr("distance")));
}

TEST(PropagationText, WhatIsNotKnownIsInfinite) {
  Propagation propagation = SomePropagation();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  propagation.points[0].uncertainty.covariance.setConstant(std::nan(""));
  propagation.points[0].uncertainty.U.setConstant(kInfinity);
  EXPECT_THAT(ToText(propagation), HasSubstr("infinite"));
}

}  // namespace
}  // namespace scancal

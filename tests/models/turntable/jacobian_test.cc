// The derivatives in closed form against dual numbers, by every quantity.
#include <ceres/jet.h>
#include <gtest/gtest.h>
#include <numeric>
#include "models/turntable.h"
#include "solver/random.h"

namespace scancal::turntable {
namespace {

constexpr int kQuantities = Model::kForm + kFormModes;
using Jet = ceres::Jet<double, kQuantities>;

struct Kind {
  const char* name;
  Model::Residuals residuals;
  bool along_range, with_influences;  // a profile without them has no bend, line, form
  double turn;                        // rad, of the normal from where it started
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class JacobianTest : public ::testing::TestWithParam<Kind> {
 protected:
  double Within(double size) { return size * (2 * random_.Uniform() - 1); }
  Eigen::MatrixXd Numbers(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return Within(1); });
  }

  void SetUp() override {
    const Kind& kind = GetParam();
    Model::SetPlane({Within(1), -1, Within(1)}, 300, &plane_);
    profile_.alpha = Within(3);
    profile_.along_range = kind.along_range;
    for (int i = 0; i < 3; ++i) profile_.points.push_back({1 + random_.Uniform(), Within(50), Within(80)});
    if (kind.with_influences) {
      profile_.bend = Numbers(3, std::ssize(Model::kBends));
      profile_.motion = {-1, 0.7, {0.3, -0.6, 0.8, 0.4}};
      profile_.line = Numbers(3, 2);
      profile_.form = Numbers(3, kFormModes);
      for (double& point : points_) point = Within(0.1);
    }
    for (double& each : q_) each = Within(0.1);
    q_[Model::kM] = -120;
    q_[Model::kN] = 400;
    for (const int k : {Model::kNormal1, Model::kNormal2}) q_[k] = Within(kind.turn);
    if (!kind.with_influences) std::fill(q_.begin() + Model::kTiltX, q_.begin() + Model::kNormal1, 0);
  }

  Random random_{7, 0};
  Model::Target plane_;
  Model::View profile_, other_{0.3, {{1, 40, -10}, {2, 50, 20}}, 2};
  std::array<double, kQuantities> q_{};
  std::array<double, 5 * kQuantities> points_{};
};

TEST_P(JacobianTest, EqualsDualNumbers) {
  const Model model(GetParam().residuals);
  ASSERT_EQ(model.quantities().size(), size_t{kQuantities});
  std::array<Jet, kQuantities> q;
  for (int k = 0; k < kQuantities; ++k) q[static_cast<size_t>(k)] = Jet(q_[static_cast<size_t>(k)], k);
  std::array<Jet, 3> expected;
  model.Residual(plane_, profile_, Seen<Jet>{q.data(), points_.data() + 2 * kQuantities, kQuantities}, expected.data());

  std::vector<int> seeds(kQuantities);
  std::iota(seeds.rbegin(), seeds.rend(), 0);
  // As the second of two profiles.
  const std::vector<Model::View> profiles = {other_, profile_};
  constexpr size_t kRows = 5;
  std::vector<double> r(kRows), jacobian(kRows * kQuantities);
  model.Jacobian(plane_, profiles, {q_.data(), points_.data(), kQuantities}, seeds, r.data(), jacobian.data());
  for (size_t i = 2; i < kRows; ++i) {
    EXPECT_NEAR(r[i], expected[i - 2].a, 1e-13 * (std::abs(expected[i - 2].a) + 1));
    for (int k = 0; k < kQuantities; ++k)
      EXPECT_NEAR(jacobian[i + kRows * static_cast<size_t>(kQuantities - 1 - k)], expected[i - 2].v[k],
                  1e-12 * (expected[i - 2].v.norm() + 1))
          << model.quantities()[static_cast<size_t>(k)].name << ", point " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(OfEvery, JacobianTest,
                         ::testing::Values(Kind{"plane", Model::Residuals::kPlane, false, true, 0.5},
                                           Kind{"plane_alone", Model::Residuals::kPlane, false, false, 0},
                                           Kind{"depth", Model::Residuals::kDepth, false, true, 0.5},
                                           Kind{"depth_alone", Model::Residuals::kDepth, false, false, 0},
                                           Kind{"depth_hardly_turned", Model::Residuals::kDepth, false, true, 5e-5},
                                           Kind{"range", Model::Residuals::kDepth, true, true, 0.5},
                                           Kind{"range_turned_far", Model::Residuals::kDepth, true, true, 3}),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace scancal::turntable

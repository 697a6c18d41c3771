// The suite that every model passes (design: a scanner is one header that satisfies one concept and passes one suite).
#pragma once
#include <gtest/gtest.h>
#include <Eigen/Dense>
#include "solver/calibrate.h"
#include "solver/uncertainty/budget.h"
#include "solver/uncertainty/covariance.h"

namespace scancal {

struct ContractOptions {
  double noise = 1;  // times the model's usual noise
  uint64_t seed = 1;
  bool compressed = true;   // false: every raw point is a row of its own
  bool reversed = false;    // targets, views and points in reverse order
  bool influences = false;  // draw every considered quantity and the mean of every prior, and declare them
};

struct ContractData {
  Problem problem;
  Estimate start;         // near, not at, the truth
  Eigen::VectorXd truth;  // of the estimated system quantities
  double count = 0;       // raw scalar observations
};

// What a model brings, as static members of a class:
//   ContractData Make(const ContractOptions&);
//   double kNoise;                           standard deviation of one observation at noise = 1
//   double kTruthTolerance;                  of every system quantity, from noiseless data
//   Eigen::VectorXd RoundTrip(double noise)  Load(Simulate()) with an exact file format: estimate minus truth
//   std::string Refusal();                   what the model says to a scene of deficient rank
//   const char* kRefusedName;                the quantity that it must name
template <class Model>
class ModelContract : public ::testing::Test {};
TYPED_TEST_SUITE_P(ModelContract);

inline Eigen::VectorXd Gradient(const Problem& problem, const Estimate& at) {
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  const std::vector<int> own = problem.With({Scope::kTarget}, Role::kEstimate);
  std::vector<int> seeds = system;
  seeds.insert(seeds.end(), own.begin(), own.end());
  const auto n = std::ssize(system), p = std::ssize(own);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n + p * std::ssize(problem.targets));
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    Eigen::VectorXd r;
    Eigen::MatrixXd jacobian;
    Stack(problem.targets[t].views, Values(problem, at, t), seeds, &r, &jacobian);
    const Eigen::VectorXd g = jacobian.transpose() * r;
    gradient.head(n) += g.head(n);
    gradient.segment(n + static_cast<Eigen::Index>(t) * p, p) += g.tail(p);
  }
  return gradient;
}

TYPED_TEST_P(ModelContract, RecoversTheTruthFromNoiselessData) {
  ContractOptions options;
  options.noise = 0;
  const ContractData data = TypeParam::Make(options);
  const Fit fit = Refine(data.problem, data.start);
  EXPECT_TRUE(fit.converged) << fit.message;
  EXPECT_LT((fit.estimate.system - data.truth).cwiseAbs().maxCoeff(), TypeParam::kTruthTolerance);
}

TYPED_TEST_P(ModelContract, LoadsWhatItSimulates) {
  EXPECT_LT(TypeParam::RoundTrip(0).cwiseAbs().maxCoeff(), TypeParam::kTruthTolerance);
}

TYPED_TEST_P(ModelContract, AutodiffEqualsCentralDifferences) {
  ContractOptions options;
  options.influences = true;
  const ContractData data = TypeParam::Make(options);
  std::vector<int> seeds;
  for (int k = 0; k < std::ssize(data.problem.quantities); ++k)
    if (data.problem.quantities[k].scope != Scope::kPoint) seeds.push_back(k);
  const Target& target = data.problem.targets.front();
  const std::vector<double> q = Values(data.problem, data.start, 0);
  Eigen::VectorXd r, above, below;
  Eigen::MatrixXd jacobian;
  Stack(target.views, q, seeds, &r, &jacobian);
  for (Eigen::Index k = 0; k < jacobian.cols(); ++k) {
    const double h = 1e-5;
    std::vector<double> moved = q;
    moved[seeds[k]] = q[seeds[k]] + h;
    Stack(target.views, moved, {}, &above, nullptr);
    moved[seeds[k]] = q[seeds[k]] - h;
    Stack(target.views, moved, {}, &below, nullptr);
    const Eigen::VectorXd difference = (above - below) / (2 * h);
    EXPECT_LT((difference - jacobian.col(k)).norm(), 1e-6 * jacobian.col(k).norm() + 1e-6)
        << data.problem.quantities[seeds[k]].name;
  }
}

TYPED_TEST_P(ModelContract, CompressionKeepsCostGradientEstimateAndCovariance) {
  ContractOptions options;
  options.noise = 0.01;  // half a micrometre where the usual noise is 50: where a Gram matrix would show
  const ContractData few = TypeParam::Make(options);
  options.compressed = false;
  const ContractData all = TypeParam::Make(options);
  EXPECT_EQ(few.problem.Count(), few.count);
  EXPECT_EQ(all.problem.Count(), few.count);
  const Eigen::VectorXd gradient = Gradient(all.problem, all.start);
  EXPECT_LT((Gradient(few.problem, few.start) - gradient).norm(), 1e-9 * gradient.norm());

  const Fit a = Refine(few.problem, few.start), b = Refine(all.problem, all.start);
  EXPECT_NEAR(a.cost, b.cost, 1e-9 * b.cost);
  EXPECT_LT((a.estimate.system - b.estimate.system).cwiseAbs().maxCoeff(), 1e-9);
  const Linearization la = Linearize(few.problem, a.estimate, Storey::kViews);
  const Linearization lb = Linearize(all.problem, b.estimate, Storey::kViews);
  for (const auto& covariance : {&NaiveCovariance, &ClusteredCovariance}) {
    const Eigen::MatrixXd ca = covariance(few.problem, la).matrix, cb = covariance(all.problem, lb).matrix;
    EXPECT_LT((ca - cb).norm(), 1e-9 * cb.norm());
  }
  EXPECT_LT((InverseInformation(la) - InverseInformation(lb)).norm(), 1e-9 * InverseInformation(lb).norm());
}

// What the residuals say of the noise, and the fit that is weighted with it, from rows that stand for many points.
TYPED_TEST_P(ModelContract, CompressionKeepsVariancesAndTheWeightedFit) {
  ContractOptions options;
  Solution solutions[2];
  for (const bool compressed : {true, false}) {
    options.compressed = compressed;
    ContractData data = TypeParam::Make(options);
    solutions[compressed] = SolveWeighted(Solve(std::move(data.problem), data.start), 1e-9);
  }
  const Solution &few = solutions[1], &all = solutions[0];
  ASSERT_EQ(few.variances->sources, all.variances->sources);
  for (Eigen::Index k = 0; k < few.variances->variance.size(); ++k) {
    const double error = std::sqrt(all.variances->covariance(k, k));
    EXPECT_NEAR(few.variances->variance[k], all.variances->variance[k], 1e-3 * error) << few.variances->sources[k];
    EXPECT_NEAR(std::sqrt(few.variances->covariance(k, k)), error, 1e-3 * error);
  }
  const Eigen::MatrixXd covariance = InverseInformation(all.linear);
  EXPECT_LT((InverseInformation(few.linear) - covariance).norm(), 1e-3 * covariance.norm());
  for (Eigen::Index k = 0; k < covariance.rows(); ++k)
    EXPECT_NEAR(few.fit.estimate.system[k], all.fit.estimate.system[k], 1e-3 * std::sqrt(covariance(k, k)));
}

// Noise, everything that is considered, and the priors, all drawn anew: the estimates must scatter as K V K' says.
TYPED_TEST_P(ModelContract, UncertaintyByPropagationEqualsItsMonteCarlo) {
  constexpr int kTrials = 600;
  ContractOptions options;
  options.influences = true;
  Eigen::MatrixXd scatter, stated;
  for (int trial = 0; trial < kTrials; ++trial) {
    options.seed = static_cast<uint64_t>(trial) + 100;
    const ContractData data = TypeParam::Make(options);
    const Fit fit = Refine(data.problem, data.start);
    ASSERT_TRUE(fit.converged) << fit.message;
    const Eigen::VectorXd error = fit.estimate.system - data.truth;
    if (trial == 0) {
      scatter = 0 * error * error.transpose();
      stated = BudgetOf(data.problem, fit.estimate, Linearize(data.problem, fit.estimate, Storey::kViews)).Total();
    }
    scatter += error * error.transpose() / kTrials;
  }
  // A standard deviation from 600 trials is known to 2.9 %.
  for (Eigen::Index k = 0; k < scatter.rows(); ++k)
    EXPECT_NEAR(std::sqrt(stated(k, k) / scatter(k, k)), 1, 4 / std::sqrt(2.0 * kTrials)) << "system quantity " << k;
}

TYPED_TEST_P(ModelContract, TheNoiseComesBack) {
  const ContractData data = TypeParam::Make({});
  const Fit fit = Refine(data.problem, data.start);
  const double quantities = static_cast<double>(Gradient(data.problem, data.start).size()),
               dof = data.count - quantities;
  EXPECT_NEAR(std::sqrt(fit.cost / dof) / TypeParam::kNoise, 1, 4 / std::sqrt(2 * dof));
}

TYPED_TEST_P(ModelContract, RankIsTheSameOffTheSolution) {
  const ContractData data = TypeParam::Make({});
  const Fit fit = Refine(data.problem, data.start);
  const Observability at = Observe(data.problem, Linearize(data.problem, fit.estimate, Storey::kViews));
  const Observability off = Observe(data.problem, Linearize(data.problem, data.start, Storey::kViews));
  EXPECT_EQ(at.undetermined, off.undetermined);
  for (Eigen::Index k = 0; k < at.singular.size(); ++k) EXPECT_NEAR(off.singular[k] / at.singular[k], 1, 0.2);
}

TYPED_TEST_P(ModelContract, RefusesASceneOfDeficientRankByName) {
  const std::string refusal = TypeParam::Refusal();
  EXPECT_NE(refusal.find(TypeParam::kRefusedName), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("not determined"), std::string::npos) << refusal;
}

TYPED_TEST_P(ModelContract, TheOrderOfPointsViewsAndTargetsDoesNotMatter) {
  ContractOptions options;
  const ContractData forward = TypeParam::Make(options);
  options.reversed = true;
  const ContractData backward = TypeParam::Make(options);
  const Fit a = Refine(forward.problem, forward.start), b = Refine(backward.problem, backward.start);
  const Eigen::MatrixXd covariance = InverseInformation(Linearize(forward.problem, a.estimate, Storey::kViews)) *
                                     TypeParam::kNoise * TypeParam::kNoise;
  for (Eigen::Index k = 0; k < a.estimate.system.size(); ++k)
    EXPECT_NEAR(a.estimate.system[k], b.estimate.system[k], 1e-10 * std::sqrt(covariance(k, k)));
}

REGISTER_TYPED_TEST_SUITE_P(ModelContract, RecoversTheTruthFromNoiselessData, LoadsWhatItSimulates,
                            AutodiffEqualsCentralDifferences, CompressionKeepsCostGradientEstimateAndCovariance,
                            CompressionKeepsVariancesAndTheWeightedFit, UncertaintyByPropagationEqualsItsMonteCarlo,
                            TheNoiseComesBack, RankIsTheSameOffTheSolution, RefusesASceneOfDeficientRankByName,
                            TheOrderOfPointsViewsAndTargetsDoesNotMatter);

}  // namespace scancal

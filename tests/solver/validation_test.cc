#include <gtest/gtest.h>
#include <cmath>
#include <numeric>
#include "solver/random.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/monte_carlo.h"

namespace scancal {
namespace {

constexpr double kNormal95 = 1.959963984540054;

// y + u x, x from `draw`.
template <class Draw>
std::vector<double> Trials(int count, double y, double u, uint64_t seed, Draw draw) {
  std::vector<double> trials;
  Random random(seed, 0);
  for (int k = 0; k < count; ++k) trials.push_back(y + u * draw(&random));
  return trials;
}
std::vector<double> NormalTrials(int count, double y, double u, uint64_t seed = 1) {
  return Trials(count, y, u, seed, [](Random* random) { return random->Normal(); });
}
double StudentT(int dof, Random* random) {
  double squares = 0;
  const double numerator = random->Normal();
  for (int k = 0; k < dof; ++k) squares += std::pow(random->Normal(), 2);
  return numerator / std::sqrt(squares / dof);
}

TEST(NumericalTolerance, IsHalfTheLastDigitOfU) {  // the examples of JCGM 101, 7.9.2
  EXPECT_NEAR(NumericalTolerance(0.00035, 2), 0.000005, 1e-18);
  EXPECT_NEAR(NumericalTolerance(0.00035, 1), 0.00005, 1e-17);
  EXPECT_NEAR(NumericalTolerance(2, 1), 0.5, 1e-15);
  EXPECT_NEAR(NumericalTolerance(0.994, 2), 0.005, 1e-16);
  EXPECT_NEAR(NumericalTolerance(0.996, 2), 0.05, 1e-15);  // 1.0
  EXPECT_NEAR(NumericalTolerance(0.96, 1), 0.5, 1e-15);    // 1
  EXPECT_NEAR(NumericalTolerance(1000, 1), 500, 1e-10);
  for (const double none : {0.0, -1.0, kInfinity, std::nan("")}) EXPECT_EQ(NumericalTolerance(none, 1), 0);
}

TEST(Validate, TakesTheOrderStatisticsOfTheGuide) {  // 7.7.2
  std::vector<double> trials(10'000);
  std::iota(trials.begin(), trials.end(), 1);
  std::reverse(trials.begin(), trials.end());
  const Validation whole = Validate(trials, {5000.5, 2886, 4750}, 1);
  EXPECT_EQ(whole.low, 250);  // q = 9500, r = 250
  EXPECT_EQ(whole.high, 9750);
  EXPECT_EQ(whole.mean, 5000.5);
  EXPECT_NEAR(whole.deviation, std::sqrt(10'000.0 * 10'001 / 12), 1e-9);
  EXPECT_EQ(whole.d_low, 0.5);
  EXPECT_EQ(whole.d_high, 0.5);
  trials.resize(101);  // 10000 down to 9900; q = int(95.95 + 1/2) = 96, r = int((5 + 1) / 2) = 3
  const Validation odd = Validate(trials, {}, 1);
  EXPECT_EQ(odd.low, 9902);
  EXPECT_EQ(odd.high, 9998);
}

TEST(Validate, PassesAnExactlyRightGaussianAtOneDigit) {
  // u = 1.2: delta is 0.42 u, two standard errors of an end are 0.053 u.
  for (uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_EQ(Validate(NormalTrials(10'000, 5, 1.2, seed), {5, 1.2, kNormal95 * 1.2}, 1).verdict, Verdict::kPass);
}

TEST(Validate, DoesNotDecideWhatTenThousandTrialsCannot) {
  // At two digits delta is 0.042 u: less than two standard errors.
  for (uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_EQ(Validate(NormalTrials(10'000, 5, 1.2, seed), {5, 1.2, kNormal95 * 1.2}, 2).verdict, Verdict::kUndecided);
  EXPECT_EQ(Validate(NormalTrials(10'000, 5, 1.2), {5, 0, 0}, 1).verdict, Verdict::kUndecided);
  EXPECT_EQ(Validate(NormalTrials(100, 5, 1.2), {5, 1.2, kNormal95 * 1.2}, 1).verdict, Verdict::kUndecided);
}

TEST(Validate, FailsAWrongIntervalAtEitherEnd) {
  const std::vector<double> trials = NormalTrials(10'000, 5, 1.2);
  EXPECT_EQ(Validate(trials, {5, 1.2, kNormal95 * 1.2 * 1.35}, 1).verdict, Verdict::kFail);
  EXPECT_EQ(Validate(trials, {5, 1.2, kNormal95 * 1.2 / 1.35}, 1).verdict, Verdict::kFail);
  EXPECT_EQ(Validate(trials, {5.7, 1.2, kNormal95 * 1.2}, 1).verdict, Verdict::kFail);
  EXPECT_EQ(Validate(trials, {4.3, 1.2, kNormal95 * 1.2}, 1).verdict, Verdict::kFail);
  EXPECT_EQ(Validate(trials, {5, 1.2, kInfinity}, 1).verdict, Verdict::kFail);
}

TEST(Validate, KnowsStudentT) {
  const std::vector<double> trials = Trials(10'000, 0, 1.2, 1, [](Random* random) { return StudentT(3, random); });
  const double k = CoverageFactor(0.95, 3);
  EXPECT_EQ(Validate(trials, {0, 1.2, k * 1.2}, 1).verdict, Verdict::kPass);
  EXPECT_EQ(Validate(trials, {0, 1.2, 2 * 1.2}, 1).verdict, Verdict::kFail);
}

TEST(Validate, FailsASkewedDistribution) {  // exponential: the interval is [0.025, 3.69], not 1 +- 1.96
  const std::vector<double> trials =
      Trials(10'000, 0, 1, 1, [](Random* random) { return -std::log(random->Uniform()); });
  const Validation result = Validate(trials, {1, 1, kNormal95}, 1);
  EXPECT_EQ(result.verdict, Verdict::kFail);
  EXPECT_NEAR(result.low, -std::log(0.975), 4 * 0.0016);  // standard errors sqrt(0.025 0.975 / 10^4) / density
  EXPECT_NEAR(result.high, -std::log(0.025), 4 * 0.063);
  EXPECT_NEAR(result.d_low, 0.985, 0.01);
}

// Two quantities: u = 1 with an interval that is right, and the same times `factor`.
AdaptiveSample Adaptive(double factor, int64_t most, std::vector<GumInterval>* gum) {
  *gum = {{3, 1, kNormal95}, {0, 1, kNormal95 * factor}};
  const auto sample = [](int64_t first, int64_t trials) {
    Eigen::MatrixXd block(trials, 2);
    Random random(1, static_cast<uint64_t>(first));
    for (Eigen::Index k = 0; k < trials; ++k) block.row(k) << 3 + random.Normal(), random.Normal();
    return block;
  };
  return SampleUntilStable(sample, *gum, 2, most);
}

Verdict VerdictOf(const AdaptiveSample& sample, const std::vector<GumInterval>& gum, Eigen::Index k) {
  const Eigen::VectorXd column = sample.trials.col(k);
  return Validate({column.data(), static_cast<size_t>(column.size())}, gum[static_cast<size_t>(k)], 2).verdict;
}

TEST(SampleUntilStable, PassesAnExactlyRightGaussianAtTwoDigits) {
  std::vector<GumInterval> gum;
  const AdaptiveSample sample = Adaptive(1.1, 1'000'000, &gum);
  EXPECT_TRUE(sample.stable);
  // The ends need 2 * 0.0267 / sqrt(h) < delta / 5 = 0.01: about h = 29 blocks. The last of four ends decides, and its
  // standard deviation is known to a seventh: some more.
  EXPECT_GE(sample.trials.rows(), 200'000);
  EXPECT_LE(sample.trials.rows(), 600'000);
  EXPECT_EQ(sample.trials.rows() % 10'000, 0);
  EXPECT_EQ(VerdictOf(sample, gum, 0), Verdict::kPass);
  EXPECT_EQ(VerdictOf(sample, gum, 1), Verdict::kFail);  // a tenth too wide: 0.2 > 0.05
  RecordProperty("trials", static_cast<int>(sample.trials.rows()));
}

TEST(SampleUntilStable, EndsAtTheMostTrials) {
  std::vector<GumInterval> gum;
  const AdaptiveSample sample = Adaptive(1, 34'000, &gum);
  EXPECT_FALSE(sample.stable);
  EXPECT_EQ(sample.trials.rows(), 34'000);
}

}  // namespace
}  // namespace scancal

#include "solver/uncertainty/resampling.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "solver/uncertainty/bootstrap.h"
#include "solver/uncertainty/monte_carlo.h"
#include "solver/uncertainty/validation.h"

namespace scancal {
namespace {

constexpr int kReplicates = 500;  // a standard deviation to 3 %
constexpr uint64_t kBootstrapSeed = 1;
constexpr int kBins = 60;
constexpr int kFewestTrials = 40;  // with fewer there is no 95 % interval

std::vector<Parameter*> Estimated(Calibration* result) {
  std::vector<Parameter*> estimated;
  for (Parameter& parameter : result->parameters)
    if (parameter.role == Role::kEstimate) estimated.push_back(&parameter);
  return estimated;
}

void AddBootstrap(const Solution& solution, Calibration* result) {
  // With so many views the clustered figure is as good, and this one takes a minute.
  constexpr size_t kMostViews = 10'000;
  size_t views = 0;
  for (const Target& target : solution.problem.targets) views += target.views.size();
  if (views > kMostViews) return;
  const Bootstrap bootstrap = ResampleViews(solution.problem, solution.linear, kReplicates, kBootstrapSeed);
  if (bootstrap.covariance.size() == 0) return;
  Eigen::Index k = 0;
  for (Parameter* parameter : Estimated(result)) {
    parameter->u_bootstrap = std::sqrt(bootstrap.covariance(k, k));
    ++k;
  }
}

// Equal bins from the smallest to the largest trial.
void AddHistogram(std::span<const double> trials, MonteCarloParameter* parameter) {
  const auto [least, most] = std::minmax_element(trials.begin(), trials.end());
  const double width = (*most - *least) / kBins;
  for (int k = 0; k <= kBins; ++k) parameter->edges.push_back(*least + k * width);
  parameter->counts.assign(kBins, 0);
  for (const double x : trials)
    ++parameter->counts[width > 0 ? std::min(kBins - 1, static_cast<int>((x - *least) / width)) : 0];
}

// All trials that were asked for, or as many as two digits take; summary counts them.
AdaptiveSample Sample(const Solution& solution, const VarianceDof& variance_dof, const MonteCarloChoice& choice,
                      const std::function<void(double)>& progress, std::span<const GumInterval> gum,
                      MonteCarloSummary* summary) {
  const auto block = [&](int64_t first, int64_t trials) {
    MonteCarloOptions options{trials, first, choice.seed, choice.threads, {}};
    if (progress)
      options.progress = [&](double done) {
        progress((static_cast<double>(first) + done * static_cast<double>(trials)) /
                 static_cast<double>(choice.trials));
      };
    MonteCarloSample sample = MonteCarlo(solution.problem, solution.fit, solution.linear, variance_dof, options);
    summary->trials += static_cast<double>(trials);
    summary->failed += static_cast<double>(sample.failed);
    return std::move(sample.estimates);
  };
  if (choice.digits == 1) return {block(0, choice.trials), true};
  return SampleUntilStable(block, gum, choice.digits, choice.trials);
}

MonteCarloParameter Compared(std::span<const double> trials, const Parameter& parameter, int digits, bool stable) {
  const Validation validation = Validate(trials, {parameter.value, parameter.u, parameter.U}, digits);
  const bool hasty = !stable && validation.verdict == Verdict::kPass;
  MonteCarloParameter result{parameter.name,
                             validation.mean,
                             validation.deviation,
                             validation.low,
                             validation.high,
                             parameter.value - parameter.U,
                             parameter.value + parameter.U,
                             validation.tolerance,
                             Name(hasty ? Verdict::kUndecided : validation.verdict),
                             {},
                             {}};
  AddHistogram(trials, &result);
  return result;
}

void AddMonteCarlo(const Solution& solution, const VarianceDof& variance_dof, const MonteCarloChoice& choice,
                   const std::function<void(double)>& progress, Calibration* result) {
  const std::vector<Parameter*> estimated = Estimated(result);
  if (estimated.empty()) return;
  std::vector<GumInterval> gum;
  for (const Parameter* parameter : estimated) gum.push_back({parameter->value, parameter->u, parameter->U});
  MonteCarloSummary& summary = result->monte_carlo;
  summary.seed = choice.seed;
  summary.digits = choice.digits;
  const AdaptiveSample sample = Sample(solution, variance_dof, choice, progress, gum, &summary);
  summary.stable = sample.stable;
  if (summary.failed > 0)
    result->warnings.push_back(
        fmt::format("Monte Carlo: {} of {} trials did not settle and are left out", summary.failed, summary.trials));
  if (sample.trials.rows() < kFewestTrials) return;
  for (size_t k = 0; k < estimated.size(); ++k) {
    const std::span<const double> trials(sample.trials.col(static_cast<Eigen::Index>(k)).data(), sample.trials.rows());
    summary.parameters.push_back(Compared(trials, *estimated[k], choice.digits, sample.stable));
    if (summary.parameters.back().verdict == Name(Verdict::kFail))
      result->warnings.push_back(fmt::format(
          "{}: value +- U and the 95 % interval of Monte Carlo differ in the {} digit of u: not all that u holds was "
          "drawn, or the estimate is far from linear or normal",
          estimated[k]->name, choice.digits == 1 ? "first" : "second"));
  }
}

}  // namespace

void AddResampling(const Solution& solution, const MonteCarloChoice& choice,
                   const std::function<void(double)>& progress, Calibration* result) {
  AddBootstrap(solution, result);
  if (choice.trials <= 0) return;
  CHECK(solution.variances) << "without weights the noise of a trial is not known";
  VarianceDof variance_dof;
  for (const std::string& source : solution.variances->sources) variance_dof[source] = solution.variances->Dof(source);
  AddMonteCarlo(solution, variance_dof, choice, progress, result);
}

}  // namespace scancal

#include "solver/uncertainty/monte_carlo.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <chrono>
#include "io/units.h"
#include "solver/weigh.h"
#include "tests/bench/comparisons.h"

namespace scancal::bench {
namespace {

void Consider(int quantity, double u, Problem* problem) {
  problem->quantities[quantity].role = Role::kConsider;
  problem->quantities[quantity].u = u;
}

}  // namespace

void CompareMonteCarlo(Table* table) {
  Say("Monte Carlo");
  turntable::Scene scene;  // as data/sample
  scene.encoder_jitter = 0.002 * kDegree;
  const std::vector<Placement> placements = Compress(turntable::Simulate(scene));
  const Start start = SearchStart(placements);
  Problem problem = BuildProblem(placements, start, turntable::Model::Residuals::kDepth);
  Consider(turntable::Model::kNoiseY, scene.noise_y, &problem);
  Consider(turntable::Model::kEncoderJitter, scene.encoder_jitter, &problem);
  const Estimate from = StartOf(problem, start);
  Weigh(&problem, from);
  const Fit fit = Refine(problem, from);
  const Linearization linear = Linearize(problem, fit.estimate, Storey::kViews);

  constexpr int kFew = 20;
  const std::vector<double> seconds = MedianSecondsOf(
      {[&] { MonteCarlo(problem, fit, linear, {}, {.trials = kFew, .threads = 1}); }, [&] { Refine(problem, from); }});
  const double trial = seconds[0] / kFew, refinement = seconds[1];
  table->AddAtMost("a Monte Carlo trial, 600 profiles; other: a refinement", Seconds(trial), Seconds(refinement),
                   Ratio(trial / refinement), trial / refinement, 3);
  const auto began = std::chrono::steady_clock::now();
  const MonteCarloSample sample = MonteCarlo(problem, fit, linear, {}, {.trials = 10'000});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - began;
  CHECK_EQ(sample.failed, 0);
  table->Add({"... 10,000 trials on all cores, elapsed", Seconds(elapsed.count()), "", "", "", ""});
  table->Note("Monte Carlo: the scene of data/sample; noise and encoder jitter are drawn.");
}

}  // namespace scancal::bench

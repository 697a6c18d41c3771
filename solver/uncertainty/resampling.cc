#include "solver/uncertainty/resampling.h"
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/parallel.h"
#include "solver/random.h"
#include "solver/uncertainty/monte_carlo.h"

namespace scancal {
namespace {

constexpr Message<double, double> kTrialsUnsettled{
    "solver.trials_unsettled", "Monte Carlo: {} of {} trials did not settle and are left out",
    "Monte-Carlo-Simulation: {} von {} Versuchen liefen nicht ein und sind weggelassen"};
constexpr Message<std::string_view, Sentence> kIntervalsDiffer{
    "solver.intervals_differ",
    "{}: value +- U and the 95 % interval of Monte Carlo differ in the {} digit of u: not all that u holds was drawn, "
    "or the estimate is far from linear or normal",
    "{}: Wert ± U und das 95-%-Intervall der Monte-Carlo-Simulation unterscheiden sich in der {} Ziffer von u: Nicht "
    "alles, was u enthält, wurde gezogen, oder die Schätzung ist weit von linear oder normalverteilt entfernt"};
constexpr Message<> kFirstDigit{"solver.first_digit", "first", "ersten"};
constexpr Message<> kSecondDigit{"solver.second_digit", "second", "zweiten"};

// How often each view is drawn; priors count once.
std::vector<double> Multiplicities(const std::vector<Block>& views, Random* random) {
  std::vector<size_t> data;
  std::vector<double> times(views.size(), 1);
  for (size_t v = 0; v < views.size(); ++v)
    if (views[v].prior.empty()) data.push_back(v);
  for (const size_t v : data) times[v] = 0;
  for (size_t k = 0; k < data.size(); ++k)
    ++times[data[static_cast<size_t>(random->Uniform() * static_cast<double>(data.size()))]];
  return times;
}

// Products of a view's rows (Q, system basis, r) with themselves, packed. Q spans what the target's own Jacobian does,
// and both are orthonormal over all views: where each is drawn once, the sum of the products is the identity. So little
// is lost by products, and a replicate is a sum.
Eigen::VectorXd PackedProducts(const Eigen::Ref<const Eigen::MatrixXd>& rows) {
  Eigen::VectorXd packed(rows.cols() * (rows.cols() + 1) / 2);
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < rows.cols(); ++i)
    for (Eigen::Index j = 0; j <= i; ++j) packed[at++] = rows.col(i).dot(rows.col(j));
  return packed;
}

Eigen::MatrixXd Unpacked(const Eigen::VectorXd& packed, Eigen::Index columns) {
  Eigen::MatrixXd products(columns, columns);
  Eigen::Index at = 0;
  for (Eigen::Index i = 0; i < columns; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) products(i, j) = products(j, i) = packed[at++];
  return products;
}

// Of what should be near the identity: no direction is nearly lost.
bool IsRegular(const Cholesky& products) {
  constexpr double kLost = 1e-5;
  return products.ok() && (products.L().diagonal().array() > kLost).all();
}

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
  if (summary.failed > 0) result->warnings.push_back(Say(kTrialsUnsettled, summary.failed, summary.trials));
  if (sample.trials.rows() < kFewestTrials) return;
  for (size_t k = 0; k < estimated.size(); ++k) {
    const std::span<const double> trials(sample.trials.col(static_cast<Eigen::Index>(k)).data(), sample.trials.rows());
    summary.parameters.push_back(Compared(trials, *estimated[k], choice.digits, sample.stable));
    if (summary.parameters.back().verdict == Name(Verdict::kFail))
      result->warnings.push_back(
          Say(kIntervalsDiffer, estimated[k]->name, Say(choice.digits == 1 ? kFirstDigit : kSecondDigit)));
  }
}

}  // namespace

Bootstrap ResampleViews(const Problem& problem, const Linearization& linear, int replicates, uint64_t seed) {
  const Eigen::Index n = linear.factor.cols();
  if (n == 0) return {};
  const Eigen::MatrixXd to_basis = linear.factor.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  std::vector<std::vector<Eigen::VectorXd>> products;  // per target and view
  for (const LinearTarget& target : linear.targets) {
    Eigen::MatrixXd all(target.r.size(), target.q.cols() + n + 1);
    if (all.size()) all << target.q, target.system_left * to_basis, target.r;
    auto& of_views = products.emplace_back();
    for (size_t v = 0; v + 1 < target.first.size(); ++v)
      of_views.push_back(PackedProducts(all.middleRows(target.first[v], target.first[v + 1] - target.first[v])));
  }
  Eigen::MatrixXd priors = Eigen::MatrixXd::Zero(n + 1, n + 1);  // the system's
  for (const Eigen::VectorXd& prior : products.back()) priors += Unpacked(prior, n + 1);

  std::vector<Eigen::VectorXd> moves(static_cast<size_t>(replicates));  // empty: not determined
  InParallel(moves.size(), 0, [&](size_t replicate) {
    Random random(seed, replicate);
    Eigen::MatrixXd left = priors;  // of (system, r), after each target's own quantities are eliminated
    for (size_t t = 0; t < problem.targets.size(); ++t) {
      const Eigen::Index own = linear.targets[t].q.cols();
      const std::vector<double> times = Multiplicities(problem.targets[t].views, &random);
      Eigen::VectorXd sum = Eigen::VectorXd::Zero((own + n + 1) * (own + n + 2) / 2);
      for (size_t v = 0; v < times.size(); ++v)
        if (times[v] > 0) sum += times[v] * products[t][v];
      const Eigen::MatrixXd drawn = Unpacked(sum, own + n + 1);
      left += drawn.bottomRightCorner(n + 1, n + 1);
      if (own == 0) continue;
      const Cholesky of_own(drawn.topLeftCorner(own, own));
      if (!IsRegular(of_own)) return;
      left -= drawn.bottomLeftCorner(n + 1, own) * of_own.Solve(drawn.topRightCorner(own, n + 1));
    }
    const Cholesky of_system(left.topLeftCorner(n, n));
    if (IsRegular(of_system)) moves[replicate] = -to_basis * of_system.Solve(left.topRightCorner(n, 1));
  });
  std::erase_if(moves, [](const Eigen::VectorXd& move) { return move.size() == 0; });
  Bootstrap result;
  result.replicates = static_cast<int>(moves.size());
  if (result.replicates < 2) return result;
  Eigen::MatrixXd used(result.replicates, n);
  for (Eigen::Index k = 0; k < used.rows(); ++k) used.row(k) = moves[static_cast<size_t>(k)].transpose();
  const Eigen::MatrixXd centred = used.rowwise() - used.colwise().mean();
  result.covariance = centred.transpose() * centred / static_cast<double>(result.replicates - 1);
  return result;
}

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

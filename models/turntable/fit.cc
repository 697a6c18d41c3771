// The joint fit of a turntable.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include "models/line/noise.h"
#include "models/median.h"
#include "models/turntable/scanner.h"
#include "solver/dense.h"
#include "solver/uncertainty/budget.h"

namespace scancal::turntable {
namespace {

// Line correlation declared as a length: what it adds to the offset and the slope of a profile of the usual size.
void DeclareLineCorrelation(const Declaration& declaration, const std::vector<Placement>& placements, Model* model) {
  if (!declaration.line_correlation) return;
  const Quantity& noise = model->quantities()[Model::kNoiseY];
  const double sigma = noise.role == Role::kConsider ? noise.u : std::max(PureOf(placements).sigma(), kLeastSigma_mm);
  std::vector<double> counts, spreads;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      counts.push_back(profile.count);
      spreads.push_back(profile.factor(1, 1) / profile.factor(0, 0));
    }
  }
  const LineNoise excess = ExcessOfCorrelatedNoise(*declaration.line_correlation, Median(counts), Median(spreads));
  for (const auto& [k, u] : {std::pair{Model::kLineOffset, excess.offset}, {Model::kLineSlope, excess.slope}}) {
    model->quantity(k).role = Role::kConsider;
    model->quantity(k).u = sigma * u;
  }
}

// To the estimate.
bool Matters(const Quantity& quantity) { return quantity.role == Role::kEstimate || quantity.value != 0; }

bool AreAlike(const std::vector<Eigen::Array2d>& sides) {
  constexpr double kEdges = 0.03;  // of a side: the edge is found to a line, or a point of one
  Eigen::Array2d least = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), most = -least;
  for (const Eigen::Array2d& each : sides) {
    least = least.min(each);
    most = most.max(each);
  }
  return sides.empty() || (most <= (1 + kEdges) * least).all();
}

// Over the sweep of a placement: 0 to 1.
std::vector<double> Elapsed(const Placement& placement) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Profile& profile : placement.profiles) {
    first = std::min(first, profile.time);
    last = std::max(last, profile.time);
  }
  std::vector<double> elapsed;
  for (const Profile& profile : placement.profiles)
    elapsed.push_back(last > first ? (profile.time - first) / (last - first) : 0);
  return elapsed;
}

constexpr Message<double, double, double, double> kOneWay{
    "turntable.one_way",
    "drift: if the depth that is shown grew by 0.1 mm over each sweep, M would come out wrong by {:+.2g} mm and N by "
    "{:+.2g} mm; over the whole measurement, by {:+.2g} mm and {:+.2g} mm. Sweeps in one direction hardly show it, and "
    "it is "
    "not in u: sweep up and down, or declare drift_sweep or drift",
    "Drift: Wüchse die angezeigte Tiefe in jedem Durchgang um 0,1 mm, so fiele M um {:+.2g} mm falsch aus und N um "
    "{:+.2g} mm; über die ganze Messung um {:+.2g} mm und {:+.2g} mm. Durchgänge in einer Richtung zeigen es kaum, und "
    "es "
    "ist nicht in u: vor und zurück drehen oder drift_sweep oder drift angeben"};

constexpr Message<double, double> kFlat{
    "turntable.flat",
    "form: plates that are 10 um rms off their planes, each in its own way, would move M by ±{:.2g} mm and N by "
    "±{:.2g} "
    "mm; no form is declared, and none is in u: declare flatness or form",
    "Form: Platten, die um 10 um (quadratisches Mittel) von ihren Ebenen abweichen, jede auf ihre Art, verschöben M um "
    "±{:.2g} mm und N um ±{:.2g} mm; angegeben ist keine Form, und u enthält keine: flatness oder form angeben"};

constexpr Message<double, double> kBetweenScans{
    "turntable.between_scans",
    "drift: depth drifts by {:.2g} mm over a scan; whether it goes on from one scan to the next, or begins anew, the "
    "data do "
    "not tell, so drift (over the whole measurement) is considered with u = {:.2g} mm. Declare drift: 0 if it begins "
    "anew, or "
    "drift: estimate if it goes on",
    "Drift: Die Tiefe driftet über einen Scan um {:.2g} mm. Ob dies von Scan zu Scan weitergeht oder jeweils von vorn "
    "beginnt, sagen die Daten nicht; drift (über die ganze Messung) ist daher mit u = {:.2g} mm berücksichtigt. drift: "
    "0 "
    "angeben, wenn es von vorn beginnt, drift: estimate, wenn es weitergeht"};

}  // namespace

std::optional<Sentence> ConsiderDriftBetweenScans(bool declared, JointFit* fit) {
  constexpr double kFound = 3;  // standard deviations
  Problem& problem = fit->solution.problem;
  const std::vector<int> estimated = problem.With({Scope::kSystem}, Role::kEstimate);
  const auto at = std::find(estimated.begin(), estimated.end(), Model::kDriftSweep);
  const double targets = static_cast<double>(problem.targets.size());
  Quantity& drift = problem.quantities[Model::kDrift];
  if (declared || at == estimated.end() || drift.role != Role::kHold || targets < 2) return std::nullopt;
  const Eigen::Index e = at - estimated.begin();
  const double size = std::abs(fit->solution.fit.estimate.system[e]);
  if (size < kFound * std::sqrt(fit->solution.naive.matrix(e, e))) return std::nullopt;
  drift.role = Role::kConsider;
  drift.u = targets * size / std::numbers::sqrt3;
  return Say(kBetweenScans, size, drift.u);
}

bool SweepsTellDrift(const std::vector<Placement>& placements) {
  constexpr double kExplained = 0.5;  // of the time's variance, by the angle and its square
  constexpr size_t kFewest = 6;
  for (const Placement& placement : placements) {
    if (placement.profiles.size() < kFewest) return false;
    const std::vector<double> elapsed = Elapsed(placement);
    Eigen::MatrixXd by(std::ssize(elapsed), 3);
    Eigen::VectorXd time(std::ssize(elapsed));
    const double sweep = std::max(placement.Sweep(), 1e-9), from = placement.profiles.front().alpha;
    for (Eigen::Index k = 0; k < time.size(); ++k) {
      const double a = (placement.profiles[static_cast<size_t>(k)].alpha - from) / sweep;
      by.row(k) << 1, a, a * a;
      time[k] = elapsed[static_cast<size_t>(k)];
    }
    const Eigen::VectorXd left = time - by * LeastSquares(by, time);
    const double all = (time.array() - time.mean()).matrix().squaredNorm();
    if (!(all > 0) || left.squaredNorm() < (1 - kExplained) * all) return false;
  }
  return !placements.empty();
}

void AddMotion(const std::vector<Placement>& placements, size_t t, std::vector<Model::View>* views) {
  const Placement& placement = placements[t];
  double first = std::numeric_limits<double>::infinity(), last = -first, coldest = first, warmest = last;
  bool timed = true;
  for (const Placement& each : placements) {
    timed &= each.timed;
    for (const Profile& profile : each.profiles) {
      first = std::min(first, profile.time);
      last = std::max(last, profile.time);
      coldest = std::min(coldest, profile.temperature);
      warmest = std::max(warmest, profile.temperature);
    }
  }
  timed &= last > first;
  const std::vector<double> elapsed = Elapsed(placement);
  std::vector<size_t> order(elapsed.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return elapsed[a] < elapsed[b]; });
  std::vector<double> speeds;
  constexpr size_t kBeside = 2;
  for (size_t i = 0; i < order.size(); ++i) {
    const size_t from = order[i < kBeside ? 0 : i - kBeside], to = order[std::min(i + kBeside, order.size() - 1)];
    const double time = elapsed[to] - elapsed[from];
    speeds.push_back(time > 0 ? (placement.profiles[to].alpha - placement.profiles[from].alpha) / time : 0);
  }
  std::vector<double> sizes;
  for (const double speed : speeds) sizes.push_back(std::abs(speed));
  const double usual = Median(sizes);
  constexpr double kRate = 3;  // time constants in the measurement
  for (size_t i = 0; i < order.size(); ++i) {
    Model::Motion& motion = (*views)[order[i]].motion;
    const Profile& profile = placement.profiles[order[i]];
    motion.speed = usual > 0 ? speeds[i] / usual : 0;
    motion.direction = std::abs(motion.speed) < 0.1 ? 0 : motion.speed > 0 ? 1 : -1;
    const double whole = timed ? (profile.time - first) / (last - first)
                               : (static_cast<double>(t) + elapsed[order[i]]) / static_cast<double>(placements.size());
    motion.elapsed = {elapsed[order[i]], whole, (1 - std::exp(-kRate * whole)) / (1 - std::exp(-kRate)),
                      warmest > coldest ? (profile.temperature - coldest) / (warmest - coldest) : 0};
  }
}

std::optional<Sentence> NoteOnDrift(const JointFit& fit) {
  const Problem& problem = fit.solution.problem;
  for (const int k : {Model::kDriftSweep, Model::kDrift, Model::kWarmUp})
    if (problem.quantities[k].role != Role::kHold) return std::nullopt;
  const std::vector<int> estimated = problem.With({Scope::kSystem}, Role::kEstimate),
                         drifts = {Model::kDriftSweep, Model::kDrift};
  constexpr double kShown_mm = 0.1;
  const Eigen::MatrixXd moves =
      -kShown_mm * SensitivitiesTo(problem, fit.solution.fit.estimate, fit.solution.linear, drifts);
  if (moves.isZero(0)) return std::nullopt;
  const auto by = [&](Eigen::Index drift, int of) {
    const auto e = std::find(estimated.begin(), estimated.end(), of) - estimated.begin();
    return e < moves.rows() ? moves(e, drift) : 0;
  };
  return Say(kOneWay, by(0, Model::kM), by(0, Model::kN), by(1, Model::kM), by(1, Model::kN));
}

std::optional<Sentence> NoteOnForm(const JointFit& fit) {
  constexpr double kShown_mm = 0.01;
  Problem problem = fit.solution.problem;
  if (problem.quantities[Model::kForm].role != Role::kHold) return std::nullopt;
  for (Quantity& quantity : problem.quantities)
    if (quantity.role == Role::kConsider) quantity.role = Role::kHold;
  for (int k = 0; k < kFormModes; ++k) {
    problem.quantities[Model::kForm + k].role = Role::kConsider;
    problem.quantities[Model::kForm + k].u = kShown_mm;
  }
  const std::vector<int> estimated = problem.With({Scope::kSystem}, Role::kEstimate);
  const Budget budget = BudgetOf(problem, fit.solution.fit.estimate, fit.solution.linear);
  const auto by = [&](int of) {
    const auto e = std::find(estimated.begin(), estimated.end(), of) - estimated.begin();
    for (const Contribution& line : budget.lines)
      if (line.source == problem.quantities[Model::kForm].Source() && e < std::ssize(estimated))
        return std::sqrt(line.covariance(e, e));
    return 0.0;
  };
  const double M = by(Model::kM), N = by(Model::kN);
  return M > 0 || N > 0 ? std::optional(Say(kFlat, M, N)) : std::nullopt;
}

JointFit Scanner::Fit(const System& system, Model::Residuals residuals, const FitChoice& choice) const {
  JointFit fit;
  std::vector<Placement> placements = placements_;
  if (choice.without) placements.erase(placements.begin() + static_cast<std::ptrdiff_t>(*choice.without));
  fit.depths = system.depths;
  fit.heights = system.heights;
  const std::vector<PlaneStorey> storeys = StoreysOf(placements, system);
  double rms = kLeastSigma_mm;
  for (const PlaneStorey& storey : storeys)
    rms = std::max(rms, storey.Rmse(system.M(), system.N(), PlaneFit::kOrthogonal));
  const double pure = PureOf(placements).sigma();
  fit.sigma = residuals == Model::Residuals::kDepth && pure > kLeastSigma_mm ? pure : rms;
  const auto model = std::make_shared<Model>(residuals);
  for (int k = 0; k < std::ssize(model_.quantities()); ++k) model->quantity(k) = model_.quantities()[k];
  for (const int k : choice.estimate) model->quantity(k).role = Role::kEstimate;
  Quantity& drift = model->quantity(Model::kDriftSweep);
  if (drift.role == Role::kHold && !declaration_.drift_held && SweepsTellDrift(placements))
    drift.role = Role::kEstimate;
  DeclareLineCorrelation(declaration_, placements, model.get());
  std::vector<Eigen::Array2d> sides;
  for (size_t t = 0; t < placements.size(); ++t) {
    Model::Target& target = fit.targets.emplace_back();
    target.name = placements[t].name;
    target.views = Views(placements[t].profiles, residuals);
    const auto [normal, distance] = storeys[t].FitPlane(system.M(), system.N());
    Model::SetPlane(normal, distance, &target);
    const bool all = choice.influences && residuals == Model::Residuals::kDepth;
    if (all || Matters(model->quantities()[Model::kForm]))
      sides.push_back(AddForm(placements[t].profiles, system, normal, distance, &target.views));
    const bool bends = std::any_of(Model::kBends.begin(), Model::kBends.end(),
                                   [&](Model::Index k) { return Matters(model->quantities()[k]); });
    if (all || bends) AddBend(system, placements[t].profiles, &target.views);
    AddMotion(placements, t, &target.views);
  }
  // One form over rectangles that differ is no longer one.
  if (const Quantity& form = model->quantities()[Model::kForm];
      form.scope == Scope::kSystem && form.role == Role::kConsider && !AreAlike(sides)) {
    fit.plate_cut_off = true;
    for (int k = 0; k < kFormModes; ++k) {
      model->quantity(Model::kForm + k).scope = Scope::kTarget;
      model->quantity(Model::kForm + k).perhaps_shared = true;
    }
  }
  Problem problem = MakeProblem<Model>(model, fit.targets);
  problem.WeighEqually(fit.sigma);
  Estimate from = NominalStart(problem);
  std::vector<double> values = Values(problem, from, 0);
  std::copy(system.q.begin(), system.q.end(), values.begin());
  SetValues(problem, values, 0, &from);
  fit.solution = Solve(std::move(problem), from, {choice.max_iterations});
  return fit;
}

JointFit Scanner::FitWeighted(const JointFit& plain, int max_iterations) const {
  JointFit fit = plain;
  fit.solution = SolveWeighted(plain.solution, kLeastSigma_mm, {max_iterations});
  return fit;
}

System JointFit::Found() const {
  const std::vector<double> values = Values(solution.problem, solution.fit.estimate, 0);
  System found{{}, depths, heights};
  std::copy_n(values.begin(), found.q.size(), found.q.begin());
  return found;
}

std::pair<Eigen::Vector3d, double> JointFit::Plane(size_t target) const {
  auto [normal, distance] = Model::Plane(targets[target], solution.fit.estimate.targets[target]);
  if (distance >= 0) return {normal, distance};
  return {-normal, -distance};
}

}  // namespace scancal::turntable

#include "solver/uncertainty/jackknife.h"
#include <algorithm>
#include <cmath>
#include "solver/dense.h"
#include "solver/uncertainty/covariance.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/neighbours.h"
#include "solver/weigh.h"

namespace scancal {
namespace {

constexpr std::ptrdiff_t kMostLeftOut = 40;

// J~' b u of everything that was considered: of target scope per target, system x quantities; of system scope stacked
// over the targets, (system targets) x quantities.
struct Considered {
  std::vector<Eigen::MatrixXd> own;
  Eigen::MatrixXd common;
};

Considered ConsideredScores(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const std::vector<int> of_target = problem.With({Scope::kTarget}, Role::kConsider);
  std::vector<int> of_system = problem.With({Scope::kSystem}, Role::kConsider);
  for (const int k : of_target)
    if (problem.quantities[k].perhaps_shared) of_system.push_back(k);  // as both
  std::vector<int> seeds = of_target;
  seeds.insert(seeds.end(), of_system.begin(), of_system.end());
  Eigen::VectorXd u(std::ssize(seeds));
  for (Eigen::Index k = 0; k < u.size(); ++k) u[k] = problem.quantities[seeds[k]].u;
  const auto n = linear.factor.cols(), m = std::ssize(problem.targets);
  Considered result{{}, Eigen::MatrixXd::Zero(n * m, std::ssize(of_system))};
  for (std::ptrdiff_t t = 0; t < m; ++t) {
    const LinearTarget& target = linear.targets[t];
    const std::vector<double> values = Values(problem, fit, static_cast<size_t>(t));
    Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(n, u.size());
    for (size_t v = 0; v < problem.targets[t].views.size() && u.size() > 0; ++v) {
      const Block& view = problem.targets[t].views[v];
      if (!view.prior.empty()) continue;
      scores += target.system_left.middleRows(target.first[v], view.size()).transpose() *
                view.Weighted(RawDerivatives(view, values, seeds));
    }
    scores *= u.asDiagonal();
    result.own.push_back(scores.leftCols(std::ssize(of_target)));
    result.common.middleRows(n * t, n) = scores.rightCols(std::ssize(of_system));
  }
  return result;
}

// Without target `out`, from the triangles of (system_left, r) of each target and of the priors. Not finite where the
// others leave something open. rest: the linearization of all; its triangle becomes that of the others.
Estimate StepWithout(size_t out, const std::vector<TriangularFactor>& triangles, Linearization* rest) {
  const Eigen::Index n = rest->factor.cols();
  TriangularFactor merged(static_cast<int>(n) + 1);
  for (size_t t = 0; t < triangles.size(); ++t)
    if (t != out) merged.Merge(triangles[t]);
  rest->factor = merged.R().topLeftCorner(n, n);
  rest->rhs = merged.R().topRightCorner(n, 1);
  return GaussNewtonStep(*rest);
}

// Whether the residuals without target `out` are where that step says, to a hundredth of the noise all together: then
// the estimate is where it says to a hundredth of u.
bool IsLinear(const Problem& problem, const Estimate& at, const Estimate& step, size_t out,
              const Linearization& linear) {
  constexpr double kOfNoise = 0.01;
  const double noise = std::sqrt(linear.cost / std::max(1.0, problem.Count() - QuantityCount(problem)));
  Estimate there = at;
  Add(step, &there);
  double squares = 0;
  Eigen::VectorXd r;
  for (size_t t = 0; t < problem.targets.size() && squares <= std::pow(kOfNoise * noise, 2); ++t) {
    if (t == out) continue;
    const LinearTarget& target = linear.targets[t];
    Stack(problem.targets[t].views, Values(problem, there, t), {}, &r, nullptr);
    const Eigen::VectorXd said =
        target.r - target.q * (target.q.transpose() * target.r) + target.system_left * step.system;
    squares += (r - said).squaredNorm();
  }
  return squares <= std::pow(kOfNoise * noise, 2);
}

}  // namespace

Jackknife LeaveOneTargetOut(const Problem& problem, const Fit& fit, const Linearization& linear) {
  Jackknife result;
  const auto m = std::ssize(problem.targets);
  if (m < 2 || m > kMostLeftOut) return result;
  result.estimates.resize(m, fit.estimate.system.size());
  std::vector<TriangularFactor> triangles;
  for (const LinearTarget& target : linear.targets) {
    Eigen::MatrixXd rows(target.r.size(), linear.factor.cols() + 1);
    if (rows.size()) rows << target.system_left, target.r;
    triangles.emplace_back(static_cast<int>(rows.cols())).Add(rows);
  }
  Linearization rest = linear;
  for (std::ptrdiff_t t = 0; t < m; ++t) {
    const auto out = static_cast<size_t>(t);
    if (const Estimate step = StepWithout(out, triangles, &rest);
        step.system.allFinite() && IsLinear(problem, fit.estimate, step, out, linear)) {
      result.estimates.row(t) = (fit.estimate.system + step.system).transpose();
      continue;
    }
    Problem others = problem;
    Estimate start = fit.estimate;
    others.targets.erase(others.targets.begin() + t);
    start.targets.erase(start.targets.begin() + t);
    const Fit without = Refine(others, start);
    result.estimates.row(t) = without.estimate.system.transpose();
    result.converged &= without.converged;
  }
  const Eigen::MatrixXd centred = result.estimates.rowwise() - result.estimates.colwise().mean();
  result.covariance = centred.transpose() * centred * static_cast<double>(m - 1) / static_cast<double>(m);
  return result;
}

ExpectedJackknife ExpectLeaveOneTargetOut(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const Considered considered = ConsideredScores(problem, fit, linear);
  std::vector<TargetScores> scores = ScoresByTarget(problem, linear);
  for (size_t t = 0; t < problem.targets.size(); ++t)
    scores[t].meat += AcrossNeighbours(problem, fit, linear, t, linear.targets[t].system_left);
  const Eigen::MatrixXd inverse = InverseInformation(linear);
  const auto n = inverse.rows();
  const size_t m = problem.targets.size();
  Eigen::MatrixXd information = 0 * inverse;
  for (const TargetScores& target : scores) information += target.information;
  // moves[i]: n x (n m), how the scores of all targets move the fit without target i.
  std::vector<Eigen::MatrixXd> moves(m);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(n, n * static_cast<Eigen::Index>(m));
  for (size_t i = 0; i < m; ++i) {
    const Eigen::MatrixXd without = SolveSquare(information - scores[i].information, Eigen::MatrixXd::Identity(n, n));
    moves[i].resize(n, mean.cols());
    for (size_t j = 0; j < m; ++j)
      moves[i].middleCols(static_cast<Eigen::Index>(j) * n, n) =
          without * ((i == j ? 1 : 0) * Eigen::MatrixXd::Identity(n, n) - scores[i].information * inverse);
    mean += moves[i] / static_cast<double>(m);
  }
  ExpectedJackknife expected{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    // Covariance of the m centred moves of this quantity; the sum of their squares is what the jackknife sees.
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(m), mean.cols());
    for (size_t i = 0; i < m; ++i) rows.row(static_cast<Eigen::Index>(i)) = moves[i].row(k) - mean.row(k);
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
    for (size_t j = 0; j < m; ++j) {
      const auto block = rows.middleCols(static_cast<Eigen::Index>(j) * n, n);
      const Eigen::MatrixXd of_own = block * considered.own[j];
      covariance += block * scores[j].meat * block.transpose() + of_own * of_own.transpose();
    }
    const Eigen::MatrixXd of_all = rows * considered.common;
    covariance += of_all * of_all.transpose();
    expected.variance[k] = covariance.trace() * static_cast<double>(m - 1) / static_cast<double>(m);
    expected.dof[k] = std::pow(covariance.trace(), 2) / covariance.squaredNorm();
  }
  return expected;
}

std::vector<TargetTest> TestTargets(const Problem& problem, const Estimate& fit, const Linearization& linear,
                                    double noise_dof) {
  constexpr double kShared = 1e-4;  // of a direction's information: less is told by the one side only
  const size_t m = problem.targets.size();
  std::vector<TargetTest> tests(m);
  const Eigen::Index n = linear.factor.cols();
  if (m < 2 || n == 0 || !(noise_dof >= 1)) return tests;
  // In the coordinates y = factor x all information is the identity.
  const auto to_y = linear.factor.triangularView<Eigen::Upper>();
  const auto scored = [&](const Eigen::MatrixXd& scores) -> Eigen::MatrixXd { return to_y.transpose().solve(scores); };
  Considered considered = ConsideredScores(problem, fit, linear);
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(n, considered.common.cols());
  for (size_t t = 0; t < m; ++t) {
    considered.own[t] = scored(considered.own[t]);
    common += considered.common.middleRows(n * static_cast<Eigen::Index>(t), n);
  }
  common = scored(common);
  std::vector<Eigen::MatrixXd> neighbours(m);  // what they add to the covariance of a target's scores
  Eigen::MatrixXd of_all = Eigen::MatrixXd::Zero(n, n);
  for (size_t t = 0; t < m; ++t) {
    neighbours[t] =
        AcrossNeighbours(problem, fit, linear, t, scored(linear.targets[t].system_left.transpose()).transpose());
    of_all += neighbours[t];
  }
  for (size_t t = 0; t < m; ++t) {
    const LinearTarget& target = linear.targets[t];
    if (target.r.size() == 0) continue;
    const Eigen::MatrixXd rows = scored(target.system_left.transpose());
    const SymmetricEigen eigen = EigenOf(rows * rows.transpose());
    std::vector<Eigen::Index> shared;
    for (Eigen::Index k = 0; k < n; ++k)
      if (eigen.values[k] > kShared && eigen.values[k] < 1 - kShared) shared.push_back(k);
    if (shared.empty()) continue;
    const Eigen::ArrayXd part = eigen.values(shared).array();
    const Eigen::MatrixXd basis = eigen.vectors(Eigen::all, shared);
    const Eigen::VectorXd score = basis.transpose() * (rows * target.r);
    // Of its score less what the joint fit takes from the scores of all.
    const Eigen::MatrixXd own = basis.transpose() * neighbours[t] * basis, taken = part.matrix().asDiagonal() * own;
    Eigen::MatrixXd of_noise = (part * (1 - part)).matrix().asDiagonal();
    of_noise += own - taken - taken.transpose() +
                part.matrix().asDiagonal() * (basis.transpose() * of_all * basis) * part.matrix().asDiagonal();
    Eigen::MatrixXd covariance = of_noise;
    // What moves the scores of target j moves this one's through the joint fit as well.
    const auto add = [&](const Eigen::MatrixXd& of_target, const Eigen::MatrixXd& all) {
      const Eigen::MatrixXd effect =
          basis.transpose() * of_target - part.matrix().asDiagonal() * (basis.transpose() * all);
      covariance += effect * effect.transpose();
    };
    for (size_t j = 0; j < m; ++j) add(j == t ? considered.own[j] : 0 * considered.own[j], considered.own[j]);
    add(scored(considered.common.middleRows(n * static_cast<Eigen::Index>(t), n)), common);
    TargetTest& test = tests[t];
    test.dof1 = static_cast<double>(shared.size());
    const Eigen::VectorXd whitened = Cholesky(covariance).Solve(score);
    test.F = score.dot(whitened) / test.dof1;
    test.p = std::min(1.0, static_cast<double>(m) * FUpperTail(test.F, test.dof1, noise_dof));
    test.moves = to_y.solve(basis * ((1 - part).inverse().matrix().asDiagonal() * (of_noise * whitened)));
  }
  return tests;
}

bool HeldOutTest::Contradicts() const {
  constexpr double kSignificant = 1e-3;
  return p < kSignificant && std::sqrt(F) > kMore;
}

HeldOutTest TestHeldOut(const Problem& held_out, const Estimate& at, const Eigen::MatrixXd& covariance,
                        double noise_dof) {
  HeldOutTest test;
  if (held_out.targets.empty() || !(noise_dof >= 1)) return test;
  Problem own = held_out;  // the system as it was found
  const std::vector<double> found = Values(held_out, at, 0);
  for (size_t k = 0; k < own.quantities.size(); ++k) {
    Quantity& quantity = own.quantities[k];
    if (quantity.scope != Scope::kSystem) continue;
    quantity.value = found[k];
    quantity.role = Role::kHold;
  }
  own.priors.clear();
  Estimate there = at;
  there.targets = Refine(own, {Eigen::VectorXd(0), at.targets}).estimate.targets;
  const Linearization linear = Linearize(held_out, there, Storey::kViews);
  const Eigen::Index n = covariance.rows();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
  double squares = 0;
  for (size_t t = 0; t < held_out.targets.size(); ++t) {
    const LinearTarget& target = linear.targets[t];
    const Eigen::VectorXd left = target.r - target.q * (target.q.transpose() * target.r);
    squares += left.squaredNorm();
    score += target.system_left.transpose() * left;
    information += target.system_left.transpose() * target.system_left;
    test.dof1 += static_cast<double>(target.r.size() - target.q.cols());
  }
  // (I + L S L')^-1 = I - L (I + S L'L)^-1 S L' (Woodbury); S may be singular, L'L, too.
  const Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(n, n) + covariance * information;
  test.F = (squares - score.dot(SolveSquare(inner, covariance * score).col(0))) / test.dof1;
  test.p = FUpperTail(test.F, test.dof1, noise_dof);
  return test;
}

}  // namespace scancal

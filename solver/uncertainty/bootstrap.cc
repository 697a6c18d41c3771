#include "solver/uncertainty/bootstrap.h"
#include <cmath>
#include "solver/random.h"
#include "solver/triangular_factor.h"

namespace scancal {
namespace {

constexpr double kRankTolerance = 1e-10;  // of a column, as in Linearize

bool IsRegular(const Eigen::Ref<const Eigen::MatrixXd>& triangle) {
  return (triangle.diagonal().array().abs() > kRankTolerance * triangle.colwise().norm().transpose().array()).all();
}

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

// Rows (system, r) with the norms of the target's weighted ones after its own quantities are eliminated; empty if they
// are not determined. `rows` are (Q, system_left, r): Q spans what the target's own Jacobian does.
Eigen::MatrixXd Eliminated(const Eigen::MatrixXd& rows, const std::vector<Eigen::Index>& first,
                           const std::vector<double>& times, Eigen::Index own) {
  TriangularFactor factor(static_cast<int>(rows.cols()));
  for (size_t v = 0; v < times.size(); ++v)
    if (times[v] > 0) factor.Add(std::sqrt(times[v]) * rows.middleRows(first[v], first[v + 1] - first[v]));
  const Eigen::MatrixXd& r = factor.R();
  const Eigen::Index left = rows.cols() - own;
  return IsRegular(r.topLeftCorner(own, own)) ? Eigen::MatrixXd(r.bottomRightCorner(left, left)) : Eigen::MatrixXd();
}

}  // namespace

Bootstrap ResampleViews(const Problem& problem, const Linearization& linear, int replicates, uint64_t seed) {
  const Eigen::Index n = linear.factor.cols();
  std::vector<Eigen::MatrixXd> rows;
  for (const LinearTarget& target : linear.targets) {
    Eigen::MatrixXd& all = rows.emplace_back(target.r.size(), target.q.cols() + n + 1);
    if (all.size()) all << target.q, target.system_left, target.r;
  }
  Eigen::MatrixXd estimates(replicates, n);
  Bootstrap result;
  for (int replicate = 0; replicate < replicates; ++replicate) {
    Random random(seed, static_cast<uint64_t>(replicate));
    TriangularFactor factor(static_cast<int>(n) + 1);
    factor.Add(rows.back());  // the system's priors
    bool determined = true;
    for (size_t t = 0; t < problem.targets.size() && determined; ++t) {
      const LinearTarget& target = linear.targets[t];
      const std::vector<double> times = Multiplicities(problem.targets[t].views, &random);
      const Eigen::MatrixXd left = Eliminated(rows[t], target.first, times, target.q.cols());
      determined = left.size() > 0;
      factor.Add(left);
    }
    if (!determined || !IsRegular(factor.R().topLeftCorner(n, n))) continue;
    estimates.row(result.replicates++) = -factor.R()
                                              .topLeftCorner(n, n)
                                              .triangularView<Eigen::Upper>()
                                              .solve(factor.R().topRightCorner(n, 1))
                                              .transpose();
  }
  if (result.replicates < 2) return result;
  const Eigen::MatrixXd used = estimates.topRows(result.replicates);
  const Eigen::MatrixXd centred = used.rowwise() - used.colwise().mean();
  result.covariance = centred.transpose() * centred / static_cast<double>(result.replicates - 1);
  return result;
}

}  // namespace scancal

#include "solver/uncertainty/neighbours.h"
#include "solver/weigh.h"

namespace scancal {

Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const std::vector<int> of_view = problem.With({Scope::kView}, Role::kConsider);
  double products = 0, squares = 0;
  Neighbours result;
  for (size_t t = 0; t < problem.targets.size(); ++t) {
    const std::vector<double> values = Values(problem, fit, t);
    const LinearTarget& target = linear.targets[t];
    Eigen::VectorXd before;
    for (size_t v = 0; v < problem.targets[t].views.size(); ++v) {
      const Block& view = problem.targets[t].views[v];
      if (!view.prior.empty()) continue;
      const Eigen::MatrixXd effects = view.Weighted(RawDerivatives(view, values, of_view)).colwise().normalized();
      const Eigen::VectorXd z = effects.transpose() * target.r.segment(target.first[v], effects.rows());
      squares += z.squaredNorm();
      if (before.size()) {
        products += z.dot(before);
        result.pairs += static_cast<double>(z.size());
      }
      before = z;
    }
  }
  if (squares > 0) result.correlation = products / squares;
  return result;
}

}  // namespace scancal

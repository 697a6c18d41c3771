#include "solver/uncertainty/neighbours.h"
#include <cmath>
#include "solver/weigh.h"

namespace scancal {

Neighbours CorrelationOfNeighbours(const Problem& problem, const Estimate& fit, const Linearization& linear) {
  const std::vector<int> of_view = problem.With({Scope::kView}, Role::kConsider);
  double products = 0, squares_of_products = 0, squares = 0;
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
        squares_of_products += z.dot(before) * z.dot(before);
      }
      before = z;
    }
  }
  if (!(squares > 0)) return {};
  return {products / squares, std::sqrt(squares_of_products) / squares};
}

}  // namespace scancal

#include "solver/weigh.h"
#include <glog/logging.h>
#include "solver/dense.h"

namespace scancal {
Eigen::MatrixXd Whitening(const Eigen::MatrixXd& covariance) {
  const Cholesky cholesky(covariance);
  CHECK(cholesky.ok()) << "a covariance must be positive definite: every row needs noise of its own";
  return cholesky.SolveLower(Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

Eigen::MatrixXd Instances(const Eigen::VectorXd& derivative, int points, Scope scope) {
  if (scope != Scope::kPoint) return derivative;
  const Eigen::Index per_point = derivative.size() / points;
  Eigen::MatrixXd instances = Eigen::MatrixXd::Zero(derivative.size(), points);
  for (int i = 0; i < points; ++i)
    instances.block(i * per_point, i, per_point, 1) = derivative.segment(i * per_point, per_point);
  return instances;
}

Eigen::MatrixXd RawDerivatives(const Block& view, const std::vector<double>& values, std::span<const int> seeds) {
  Eigen::VectorXd r;
  Eigen::MatrixXd derivatives;
  Block{view.rows, 1, {}, {}, {}}.Evaluate(values.data(), seeds, &r, &derivatives);
  return derivatives;
}

void Weigh(Problem* problem, const Estimate& at) {
  const std::vector<int> noise = problem->With({Scope::kView, Scope::kPoint}, Role::kConsider);
  for (size_t t = 0; t < problem->targets.size(); ++t) {
    const std::vector<double> values = Values(*problem, at, t);
    for (Block& view : problem->targets[t].views) {
      if (!view.prior.empty()) continue;
      const Eigen::MatrixXd derivatives = RawDerivatives(view, values, noise);
      Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(derivatives.rows(), derivatives.rows());
      for (Eigen::Index k = 0; k < derivatives.cols(); ++k) {
        const Quantity& quantity = problem->quantities[noise[k]];
        const Eigen::MatrixXd b = Instances(derivatives.col(k) * quantity.u, view.rows->points(), quantity.scope);
        covariance += b * b.transpose();
      }
      view.weight = 1;
      view.mix = Whitening(covariance);
    }
    problem->targets[t].MixNodes();
  }
}

}  // namespace scancal

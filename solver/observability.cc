#include "solver/observability.h"
#include <Eigen/SVD>

namespace scancal {
namespace {

constexpr double kNoEffect = 1e-9;   // relative to a quantity's effect before elimination: rounding
constexpr double kTakesPart = 0.05;  // of a unit vector

}  // namespace

Observability Observe(const Problem& problem, const Linearization& linear) {
  Observability result;
  for (size_t t = 0; t < problem.targets.size(); ++t)
    if (!linear.targets[t].own_determined) result.undetermined_targets.push_back(problem.targets[t].name);
  const std::vector<int> system = problem.With({Scope::kSystem}, Role::kEstimate);
  if (system.empty()) return result;
  const Eigen::VectorXd scale = linear.system_norm.cwiseMax(1e-300).cwiseInverse();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(linear.factor * scale.asDiagonal(), Eigen::ComputeFullV);
  result.singular = svd.singularValues();
  const Eigen::Index last = result.singular.size() - 1;
  result.condition = result.singular[0] / result.singular[last];
  result.weakest = svd.matrixV().col(last);
  for (size_t k = 0; k < system.size(); ++k) {
    bool found = false;
    for (Eigen::Index i = 0; i <= last; ++i)
      found |= result.singular[i] < kNoEffect && std::abs(svd.matrixV()(static_cast<Eigen::Index>(k), i)) > kTakesPart;
    if (found) result.undetermined.push_back(problem.quantities[system[k]].name);
  }
  return result;
}

}  // namespace scancal

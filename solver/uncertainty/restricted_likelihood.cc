#include "solver/uncertainty/restricted_likelihood.h"
#include <Eigen/Cholesky>

namespace scancal {

RestrictedLikelihood::RestrictedLikelihood(Eigen::Index sources, size_t targets, Eigen::Index own, Eigen::Index system)
    : score_(Eigen::VectorXd::Zero(sources)),
      information_(Eigen::MatrixXd::Zero(sources, sources)),
      average_(Eigen::MatrixXd::Zero(sources, sources)),
      own_pull_(targets, Eigen::MatrixXd::Zero(own, sources)),
      system_pull_(Eigen::MatrixXd::Zero(system, sources)),
      projected_(sources, {std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, own)),
                           std::vector<Eigen::MatrixXd>(targets, Eigen::MatrixXd::Zero(own, system)),
                           Eigen::MatrixXd::Zero(system, system)}) {}

double RestrictedLikelihood::Projected::TraceOfProduct(const Projected& other) const {
  double trace = system.cwiseProduct(other.system).sum();
  for (size_t t = 0; t < own.size(); ++t)
    trace += own[t].cwiseProduct(other.own[t]).sum() + 2 * across[t].cwiseProduct(other.across[t]).sum();
  return trace;
}

void RestrictedLikelihood::Add(size_t target, const Block& view, const ViewEffects& effects, const Eigen::VectorXd& r,
                               const Eigen::MatrixXd& own, const Eigen::MatrixXd& system, double point_variance) {
  const auto n = score_.size();
  const double more = view.rows->count() - static_cast<double>(r.size());
  std::vector<Eigen::MatrixXd> f(n), of_own(n), of_system(n);
  Eigen::VectorXd row = Eigen::VectorXd::Zero(n);  // of the point noise per row
  Eigen::MatrixXd pulled(r.size(), n);             // V_k P r, whitened
  for (Eigen::Index k = 0; k < n; ++k) {
    f[k] = view.Weighted(effects.of_source[k]);
    of_own[k] = f[k].transpose() * own;
    of_system[k] = f[k].transpose() * system;
    if (effects.of_points[k])
      row[k] = effects.of_source[k].squaredNorm() / static_cast<double>(r.size()) / point_variance;
    const Eigen::VectorXd on_r = f[k].transpose() * r;
    pulled.col(k) = f[k] * on_r;
    score_[k] += 0.5 * (on_r.squaredNorm() - f[k].squaredNorm() - more * row[k]);
    projected_[k].own[target] += of_own[k].transpose() * of_own[k];
    projected_[k].across[target] += of_own[k].transpose() * of_system[k];
    projected_[k].system += of_system[k].transpose() * of_system[k];
  }
  own_pull_[target] += own.transpose() * pulled;
  system_pull_ += system.transpose() * pulled;
  average_ += 0.5 * pulled.transpose() * pulled;
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index l = 0; l <= k; ++l) {
      const Eigen::MatrixXd between = f[k].transpose() * f[l];
      const double through = (of_own[k].transpose() * between).cwiseProduct(of_own[l].transpose()).sum() +
                             (of_system[k].transpose() * between).cwiseProduct(of_system[l].transpose()).sum();
      information_(k, l) += 0.5 * (between.squaredNorm() - 2 * through + more * row[k] * row[l]);
    }
  }
}

void RestrictedLikelihood::Finish() {
  average_ -= 0.5 * system_pull_.transpose() * system_pull_;
  for (const Eigen::MatrixXd& pull : own_pull_) average_ -= 0.5 * pull.transpose() * pull;
  for (Eigen::Index k = 0; k < score_.size(); ++k) {
    double trace = projected_[k].system.trace();
    for (const Eigen::MatrixXd& own : projected_[k].own) trace += own.trace();
    score_[k] += 0.5 * trace;
    for (Eigen::Index l = 0; l <= k; ++l) {
      information_(k, l) += 0.5 * projected_[k].TraceOfProduct(projected_[l]);
      information_(l, k) = information_(k, l);
    }
  }
}

Eigen::MatrixXd RestrictedLikelihood::Curvature() const {
  const Eigen::MatrixXd observed = 2 * average_ - information_;
  return Eigen::LLT<Eigen::MatrixXd>(observed).info() == Eigen::Success ? observed : average_;
}

}  // namespace scancal

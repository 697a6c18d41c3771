#include "solver/judge.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "solver/uncertainty/coverage.h"

namespace scancal {
namespace {

constexpr double kSuspicious = 1e-3;     // a warning that a right data set raises once in a thousand
constexpr double kContradiction = 1e-6;  // no chance any more
constexpr double kFarFromPrior = 3;      // of the prior's u

std::string LeastDetermined(const std::map<std::string, double>& direction) {
  const auto worst = std::max_element(direction.begin(), direction.end(), [](const auto& a, const auto& b) {
    return std::abs(a.second) < std::abs(b.second);
  });
  if (worst == direction.end()) return "";
  return "; " + worst->first + " is least determined: hold it, give it a prior, or allow more iterations";
}

void JudgeJackknife(const Solution& solution, const Jackknife& jackknife, double clustered_dof, Calibration* result) {
  if (jackknife.estimates.rows() < 2 || clustered_dof < 1) return;
  const ExpectedJackknife expected = ExpectLeaveOneTargetOut(solution.problem, solution.linear);
  for (size_t k = 0; k < result->estimated.size(); ++k) {
    const auto e = static_cast<Eigen::Index>(k);
    // What no target moves, because only its prior or a declaration holds it, is rounding over rounding.
    if (!(expected.variance[e] > 1e-12 * result->covariance(e, e))) continue;
    const double ratio = jackknife.covariance(e, e) / expected.variance[e];
    const double p = FUpperTail(ratio, expected.dof[e], clustered_dof);
    if (p >= kSuspicious) continue;
    (p < kContradiction ? result->unreliable : result->warnings)
        .push_back(fmt::format(
            "{}: leaving one target out moves it {:.2g} times as far as its u explains; the targets disagree, "
            "so u is too small, or the model lacks something",
            result->estimated[k], std::sqrt(ratio)));
  }
}

void JudgeFit(const LackOfFit& fit, Calibration* result) {
  if (fit.dof1 == 0 || fit.p >= kSuspicious) return;
  result->warnings.push_back(fmt::format(
      "lack of fit: F = {:.3g}: views differ by more than the noise within them explains. The naive "
      "uncertainty is too small; the clustered one allows for errors that are independent from view to view, "
      "not for a wrong model or form",
      fit.F));
}

// A prior is a measurement; a result far from it says that one of the two is wrong.
void JudgePriors(const Problem& problem, Calibration* result) {
  for (const Quantity& quantity : problem.quantities) {
    const Parameter* parameter = result->Find(quantity.name);
    if (!parameter || parameter->role != Role::kEstimate || !(quantity.u > 0)) continue;
    const double apart = std::abs(parameter->value - quantity.value) / quantity.u;
    if (apart > kFarFromPrior)
      result->unreliable.push_back(
          fmt::format("{}: its prior and the data disagree: the result lies {:.2g} times the prior's u away from it",
                      quantity.name, apart));
  }
}

}  // namespace

void Judge(const Solution& solution, const Jackknife& jackknife, double clustered_dof, Calibration* calibration) {
  JudgeJackknife(solution, jackknife, clustered_dof, calibration);
  JudgeFit(calibration->lack_of_fit, calibration);
  JudgePriors(solution.problem, calibration);
  if (!calibration->estimated.empty() && clustered_dof < 1)
    calibration->unreliable.push_back(
        "too few views: not more than there are quantities to estimate, so their scatter tells nothing");
  if (!solution.fit.converged)
    calibration->unreliable.push_back("the refinement did not converge: " + solution.fit.message +
                                      LeastDetermined(calibration->weakest));
}

}  // namespace scancal

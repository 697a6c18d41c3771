#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "solver/calibrate.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/misfit.h"
#include "solver/uncertainty/neighbours.h"

namespace scancal {
namespace {

constexpr Message<std::string_view, double> kTargetsDisagree{
    "solver.targets_disagree",
    "{}: leaving one target out moves it {:.2g} times as far as its u explains; the targets disagree, so u is too "
    "small, or the model lacks something",
    "{}: Wird ein Prüfkörper weggelassen, so ändert sich der Wert {:.2g}-mal so stark, wie es u erklärt; die "
    "Prüfkörper widersprechen einander: u ist zu klein, oder dem Modell fehlt etwas"};
constexpr Message<std::string_view, Sentence, double, Sentence, double, Sentence, Sentence, Sentence, Sentence> kMisfit{
    "solver.misfit",
    "lack of fit: {} is {}, but the residuals ask for {:.2g}{} (F = {:.3g}, {}), which would move {}{}; {}",
    "Mangelnde Anpassung: {} ist {}, die Residuen verlangen jedoch {:.2g}{} (F = {:.3g}, {}); das verschöbe {}{}. {}"};
constexpr Message<> kEstimateIt{"solver.estimate_it",
                                "estimate it, or declare how uncertain it is, if it is what it looks like",
                                "Schätzen oder die Unsicherheit angeben, wenn es das ist, wonach es aussieht"};
constexpr Message<> kDeclareIt{
    "solver.declare_it", "declare how uncertain it is, if it is what it looks like: data alone do not tell it apart",
    "Die Unsicherheit angeben, wenn es das ist, wonach es aussieht: Die Daten allein trennen "
    "es nicht ab"};
constexpr Message<std::string_view, std::string_view, double, std::string_view, double> kMove{
    "solver.move", "{} by {}{:.2g} {} ({:.2g} u)", "{} um {}{:.2g} {} ({:.2g} u)"};
constexpr Message<> kHeld{"solver.held", "held", "festgehalten"};
constexpr Message<> kUnderestimated{"solver.underestimated", "considered with a smaller u",
                                    "mit kleinerer Unsicherheit berücksichtigt"};
constexpr Message<double> kChance{"solver.chance", "p = {:.1g}", "p = {:.1g}"};
constexpr Message<std::string_view> kAlsoSeenAs{"solver.also_seen_as", " (also seen as {})",
                                                " (ebenso gedeutet als {})"};
constexpr Message<double, double> kNeighboursCorrelated{
    "solver.neighbours_correlated",
    "neighbouring views are correlated ({:.2g}), but count as independent: as far as that is neither form nor a wrong "
    "model, u is too small by a factor of about {:.2g}",
    "Benachbarte Ansichten sind korreliert ({:.2g}), zählen aber als unabhängig: Soweit dies weder Formabweichung noch "
    "ein falsches Modell ist, ist u etwa um den Faktor {:.2g} zu klein"};
constexpr Message<double> kTooSlowForNoise{
    "solver.too_slow_for_noise",
    "the residuals wander along the views, and so slowly (correlation {:.2g} from one view to the next) that it is no "
    "noise: drift, form, or something that the model lacks; u does not hold it",
    "Die Residuen wandern längs der Ansichten, und so langsam (Korrelation {:.2g} von einer zur nächsten), dass es "
    "kein "
    "Rauschen ist: Drift, Formabweichung oder etwas, das dem Modell fehlt; u enthält es nicht"};
constexpr Message<std::string_view, double, std::string_view> kSmoothErrors{
    "solver.smooth_errors",
    "{} is held, but smooth errors of {:.2g}{} in the targets explain the residuals better than noise does; declare "
    "them: u does not hold them",
    "{} ist festgehalten, glatte Abweichungen der Prüfkörper von {:.2g}{} erklären die Residuen jedoch besser als "
    "Rauschen; sie sind anzugeben, u enthält sie nicht"};
constexpr Message<double, double> kNeighboursCounted{"solver.neighbours_counted",
                                                     "the noise of neighbouring views is correlated ({:.2g}, "
                                                     "estimated); u allows for it, and would be smaller by a factor of "
                                                     "about {:.2g} without",
                                                     "Das Rauschen benachbarter Ansichten ist korreliert ({:.2g}, "
                                                     "geschätzt); u berücksichtigt dies und wäre sonst etwa um "
                                                     "den Faktor {:.2g} kleiner"};
constexpr Message<std::string_view, double, double> kDeclaredTooSmall{
    "solver.declared_too_small",
    "{}: declared with u = {:.3g}, but the residuals show {:.3g} (mm, rad); the larger one is used",
    "{}: angegeben mit u = {:.3g}, die Residuen zeigen jedoch {:.3g} (mm, rad); der größere Wert wird verwendet"};
constexpr Message<std::string_view, double, double, double, Sentence> kDeclaredExcluded{
    "solver.declared_excluded",
    "{}: declared with u = {:.3g}, but the residuals show {:.3g} (mm, rad), {:.2g} times as much ({}): the data "
    "contradict the declaration, or the model lacks something; declare what holds here, or estimate",
    "{}: angegeben mit u = {:.3g}, die Residuen zeigen jedoch {:.3g} (mm, rad), das {:.2g}-Fache ({}): Die Daten "
    "widersprechen der Angabe, oder dem Modell fehlt etwas; angeben, was hier gilt, oder estimate"};
constexpr Message<std::string_view, double, Sentence> kDeclaredNone{
    "solver.declared_none",
    "{}: declared with u = 0, but the residuals show {:.3g} (mm, rad; {}): the data contradict the declaration, or the "
    "model lacks something; declare what holds here, or estimate",
    "{}: angegeben mit u = 0, die Residuen zeigen jedoch {:.3g} (mm, rad; {}): Die Daten widersprechen der Angabe, "
    "oder "
    "dem Modell fehlt etwas; angeben, was hier gilt, oder estimate"};
constexpr Message<std::string_view, double, double, double, Sentence, size_t, std::string_view, double, size_t>
    kTargetContradicts{
        "solver.target_contradicts",
        "{} contradicts the other targets: F = {:.3g} ({:.3g}, {:.3g} degrees of freedom, {}, corrected for {} "
        "targets); "
        "without it {} moves by {:.2g} u ({} of the targets do so): check it, or the model lacks something",
        "{} widerspricht den übrigen Prüfkörpern: F = {:.3g} ({:.3g}, {:.3g} Freiheitsgrade, {}, korrigiert für {} "
        "Prüfkörper); ohne ihn verschiebt sich {} um das {:.2g}-Fache von u ({} der Prüfkörper verhalten sich so): "
        "prüfen, oder dem Modell fehlt etwas"};
constexpr Message<> kVariancesUnsettled{
    "solver.variances_unsettled", "the variances did not settle; compare u with u clustered",
    "Die Varianzen liefen nicht ein; u ist mit der gruppierten Unsicherheit zu vergleichen"};
constexpr Message<double> kLackOfFit{
    "solver.lack_of_fit",
    "lack of fit: F = {:.3g}: views differ by more than the noise within them explains. The naive uncertainty is too "
    "small; the clustered one allows for errors that are independent from view to view, not for a wrong model or form",
    "Mangelnde Anpassung: F = {:.3g}: Die Ansichten unterscheiden sich stärker, als es das Rauschen innerhalb einer "
    "Ansicht erklärt. Die naive Unsicherheit ist zu klein; die gruppierte lässt Abweichungen zu, die von Ansicht zu "
    "Ansicht unabhängig sind, aber kein falsches Modell und keine Formabweichung"};
constexpr Message<std::string_view, double> kPriorDisagrees{
    "solver.prior_disagrees",
    "{}: its prior and the data disagree: the result lies {:.2g} times the prior's u away from it",
    "{}: Vorwissen und Daten widersprechen einander: Das Ergebnis liegt um das {:.2g}-Fache der Unsicherheit des "
    "Vorwissens von diesem entfernt"};
constexpr Message<> kOverflow{
    "solver.overflow", "the uncertainties overflow: something was declared with an absurd u",
    "Die Unsicherheiten übersteigen den Zahlenbereich: Etwas wurde mit einer unsinnigen Unsicherheit angegeben"};
constexpr Message<> kTooFewViews{
    "solver.too_few_views",
    "too few views: not more than there are quantities to estimate, so their scatter tells nothing",
    "Zu wenige Ansichten: nicht mehr, als Größen zu schätzen sind; ihre Streuung sagt daher nichts aus"};
constexpr Message<Sentence> kNotConverged{"solver.not_converged", "the refinement did not converge: {}",
                                          "Die Ausgleichung konvergierte nicht: {}"};
constexpr Message<Sentence, std::string_view> kLeastDetermined{
    "solver.least_determined",
    "the refinement did not converge: {}; {} is least determined: hold it, give it a prior, or allow more iterations",
    "Die Ausgleichung konvergierte nicht: {}; am wenigsten bestimmt ist {}: festhalten, Vorwissen angeben oder mehr "
    "Iterationen zulassen"};

constexpr double kContradiction = 1e-6;  // no chance any more
constexpr double kNearly = 0.8;          // of the strongest
constexpr double kExcluded = 1.3;        // times what was declared
constexpr double kFarFromPrior = 3;      // of the prior's u

Sentence NotConverged(const Sentence& why, const std::map<std::string, double>& direction) {
  const auto worst = std::max_element(direction.begin(), direction.end(), [](const auto& a, const auto& b) {
    return std::abs(a.second) < std::abs(b.second);
  });
  return worst == direction.end() ? Say(kNotConverged, why) : Say(kLeastDetermined, why, worst->first);
}

void JudgeJackknife(const Solution& solution, const Jackknife& jackknife, double noise_dof, Calibration* result) {
  if (jackknife.estimates.rows() < 2 || noise_dof < 1) return;
  const ExpectedJackknife expected = ExpectLeaveOneTargetOut(solution.problem, solution.fit.estimate, solution.linear);
  for (size_t k = 0; k < result->estimated.size(); ++k) {
    const auto e = static_cast<Eigen::Index>(k);
    // What no target moves, because only its prior or a declaration holds it, is rounding over rounding.
    if (!(expected.variance[e] > 1e-12 * result->covariance(e, e))) continue;
    const double ratio = jackknife.covariance(e, e) / expected.variance[e];
    const double p = FUpperTail(ratio, expected.dof[e], noise_dof);
    if (p >= kSuspicious) continue;
    (p < kContradiction ? result->unreliable : result->warnings)
        .push_back(Say(kTargetsDisagree, result->estimated[k], std::sqrt(ratio)));
  }
}

Sentence Chance(double p) { return p < 1e-16 ? Sentence{"p < 1e-16"} : Say(kChance, p); }

// The most significant of those that matter; the others say the same.
void JudgeTargets(const Solution& solution, double noise_dof, Calibration* result) {
  const std::vector<TargetTest> tests =
      TestTargets(solution.problem, solution.fit.estimate, solution.linear, noise_dof);
  size_t worst = 0, count = 0;
  for (size_t t = 0; t < tests.size(); ++t) {
    count += tests[t].p < kSuspicious;
    if (tests[t].p < tests[worst].p || (tests[t].p == tests[worst].p && tests[t].F > tests[worst].F)) worst = t;
  }
  if (count == 0) return;
  const TargetTest& test = tests[worst];
  const auto [which, furthest] = Furthest(Plain(test.moves), *result);
  (furthest > 1 ? result->unreliable : result->warnings)
      .push_back(Say(kTargetContradicts, solution.problem.targets[worst].name, test.F, test.dof1, noise_dof,
                     Chance(test.p), tests.size(), which, furthest, count));
}

// A number's unit in words, an angle in degrees besides.
Sentence InUnit(double size, Unit unit, bool rms) {
  std::string text = unit == Unit::kOne ? "" : " " + std::string(Name(unit));
  if (rms) text += " rms";
  if (unit == Unit::kRad) text += fmt::format(", {:.2g} deg", size / (std::numbers::pi / 180));
  return {text};
}

// The three parameters that move farthest in units of their u, in their own order: "M by -0.12 mm (5.6 u), N by ...".
Sentence MovesOf(const MisfitTest& misfit, const Calibration& result, double* furthest) {
  constexpr size_t kMost = 3;
  constexpr double kAny = 0.1;
  std::vector<double> in_u;
  for (size_t k = 0; k < result.estimated.size(); ++k)
    in_u.push_back(std::abs(misfit.moves[k]) / result.Find(result.estimated[k])->u);
  std::vector<double> sorted = in_u;
  std::sort(sorted.rbegin(), sorted.rend());
  *furthest = sorted.empty() ? 0 : sorted[0];
  const double least = std::min(*furthest, std::max(kAny, sorted.size() > kMost ? sorted[kMost - 1] : 0));
  Sentence all;
  for (size_t k = 0; k < in_u.size(); ++k) {
    if (in_u[k] < least) continue;
    const Parameter& p = *result.Find(result.estimated[k]);
    const char* sign = misfit.dof1 > 1 ? "±" : misfit.moves[k] < 0 ? "-" : "+";
    const Sentence move = Say(kMove, p.name, sign, std::abs(misfit.moves[k]), Name(p.unit), in_u[k]);
    all.english += (all.english.empty() ? "" : ", ") + move.english;
    all.german += (all.german.empty() ? "" : ", ") + move.german;
    all.id = move.id;
  }
  return all;
}

// Which of the significant ones is named first. One quantity that explains what many do is the simpler cause: the
// first, in the model's order, of those that explain nearly as much as the best. If a source of several, as the form of
// a plate is, explains more than chance would give its further quantities, it comes before.
const MisfitTest* Likeliest(const std::vector<const MisfitTest*>& significant) {
  constexpr double kChanceOf = 3.1;  // normal quantile of 0.001
  const auto explained = [](const MisfitTest& test) { return test.F * test.dof1; };
  const MisfitTest *single = nullptr, *several = nullptr;
  double best = 0;
  for (const MisfitTest* each : significant)
    if (each->dof1 <= 1) best = std::max(best, explained(*each));
  for (const MisfitTest* each : significant) {
    if (each->dof1 <= 1 && !single && explained(*each) >= kNearly * best) single = each;
    if (each->dof1 > 1 && (!several || explained(*each) - 2 * each->dof1 > explained(*several) - 2 * several->dof1))
      several = each;
  }
  if (!several) return single;
  const double more = several->dof1 - (single ? 1 : 0);
  return explained(*several) - best > more + kChanceOf * std::sqrt(2 * more) ? several : single ? single : several;
}

// Several sources may look alike.
void JudgeMisfits(Calibration* result) {
  std::vector<const MisfitTest*> significant;
  for (const MisfitTest& misfit : result->misfits)
    if (misfit.p < kSuspicious) significant.push_back(&misfit);
  if (significant.empty()) return;
  const MisfitTest* strongest = Likeliest(significant);
  std::string others;
  for (const MisfitTest* each : significant)
    if (each != strongest) others += (others.empty() ? "" : ", ") + each->source;
  const auto influence = std::find_if(result->influences.begin(), result->influences.end(),
                                      [&](const Influence& each) { return each.source == strongest->source; });
  const bool of_targets = influence != result->influences.end() && influence->scope == Scope::kTarget;
  double furthest = 0;
  const Sentence moves = MovesOf(*strongest, *result, &furthest);
  (furthest > 1 ? result->unreliable : result->warnings)
      .push_back(Say(kMisfit, strongest->source, Say(strongest->considered ? kUnderestimated : kHeld), strongest->size,
                     InUnit(strongest->size, strongest->unit, strongest->dof1 > 1), strongest->F, Chance(strongest->p),
                     moves, others.empty() ? Sentence{} : Say(kAlsoSeenAs, others),
                     Say(of_targets ? kDeclareIt : kEstimateIt)));
}

void JudgeNeighbours(const Solution& solution, Calibration* result) {
  const Neighbours neighbours = CorrelationOfNeighbours(solution.problem, solution.fit.estimate, solution.linear);
  if (result->neighbour_noise > 0) {
    result->notes.push_back(
        Say(kNeighboursCounted, result->neighbour_noise,
            std::sqrt(1 + 2 * std::max(0.0, neighbours.correlation) / (1 - result->neighbour_noise))));
    return;
  }
  if (solution.neighbours.what == NeighboursFound::kSmooth) {
    const Quantity* held = nullptr;
    for (const Quantity& q : solution.problem.quantities)
      if (q.Source() == solution.neighbours.source) held = &q;
    const std::string unit = held && held->unit != Unit::kOne ? " " + std::string(Name(held->unit)) : "";
    const auto said = [&](const MisfitTest& test) {
      return test.source == solution.neighbours.source && test.p < kSuspicious;
    };
    if (std::none_of(result->misfits.begin(), result->misfits.end(), said))
      result->unreliable.push_back(Say(kSmoothErrors, solution.neighbours.source, solution.neighbours.u, unit));
  }
  // What is considered looks the same, and is in u.
  if (!solution.problem.With({Scope::kSystem, Scope::kTarget}, Role::kConsider).empty()) return;
  if (solution.neighbours.what == NeighboursFound::kTooSlow && result->sigma >= kLeastSigma_mm) {
    result->unreliable.push_back(Say(kTooSlowForNoise, solution.neighbours.correlation));
    return;
  }
  // Of data without noise rounding is left, which is no noise of neighbours.
  if (!neighbours.IsSignificant() || result->sigma < kLeastSigma_mm) return;
  // The variance of the mean of a series whose correlation falls as rho^lag is (1 + rho) / (1 - rho) times that of an
  // independent one (Zhang, Metrologia 43, 2006, S276).
  constexpr double kFarTooSmall = 2;
  const double factor = std::sqrt((1 + neighbours.correlation) / (1 - neighbours.correlation));
  (factor > kFarTooSmall ? result->unreliable : result->warnings)
      .push_back(Say(kNeighboursCorrelated, neighbours.correlation, factor));
}

void JudgeVariances(const Variances& variances, Calibration* result) {
  for (const auto& [source, declared, estimated, p] : variances.exceeded) {
    if (p < kSuspicious && declared == 0) {
      result->unreliable.push_back(Say(kDeclaredNone, source, estimated, Chance(p)));
    } else if (p < kSuspicious && estimated > kExcluded * declared) {
      result->unreliable.push_back(
          Say(kDeclaredExcluded, source, declared, estimated, estimated / declared, Chance(p)));
    } else {
      result->warnings.push_back(Say(kDeclaredTooSmall, source, declared, estimated));
    }
  }
  if (!variances.converged) result->warnings.push_back(Say(kVariancesUnsettled));
}

void JudgeFit(const LackOfFit& fit, Calibration* result) {
  if (fit.dof1 == 0 || fit.p >= kSuspicious) return;
  result->warnings.push_back(Say(kLackOfFit, fit.F));
}

// A prior is a measurement; a result far from it says that one of the two is wrong.
void JudgePriors(const Problem& problem, Calibration* result) {
  for (const Quantity& quantity : problem.quantities) {
    const Parameter* parameter = result->Find(quantity.name);
    if (!parameter || parameter->role != Role::kEstimate || !(quantity.u > 0)) continue;
    const double apart = std::abs(parameter->value - quantity.value) / quantity.u;
    if (apart > kFarFromPrior) result->unreliable.push_back(Say(kPriorDisagrees, quantity.name, apart));
  }
}

}  // namespace

std::pair<std::string, double> Furthest(const std::vector<double>& moves, const Calibration& result) {
  std::pair<std::string, double> furthest;
  for (size_t k = 0; k < result.estimated.size(); ++k)
    if (const double in_u = std::abs(moves[k]) / result.Find(result.estimated[k])->u; in_u > furthest.second)
      furthest = {result.estimated[k], in_u};
  return furthest;
}

void AddDoubts(const Solution& solution, const Jackknife& jackknife, double noise_dof, Calibration* calibration) {
  JudgeJackknife(solution, jackknife, noise_dof, calibration);
  if (solution.variances) {
    JudgeTargets(solution, noise_dof, calibration);
    JudgeMisfits(calibration);
    JudgeVariances(*solution.variances, calibration);
    JudgeNeighbours(solution, calibration);
  } else {
    JudgeFit(calibration->lack_of_fit, calibration);
  }
  JudgePriors(solution.problem, calibration);
  if (!calibration->covariance.allFinite()) calibration->unreliable.push_back(Say(kOverflow));
  if (!calibration->estimated.empty() && noise_dof < 1) calibration->unreliable.push_back(Say(kTooFewViews));
  if (!solution.fit.converged)
    calibration->unreliable.push_back(NotConverged(solution.fit.message, calibration->weakest));
}

}  // namespace scancal

#include "models/robot_ball/judge.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include "io/message.h"
#include "io/units.h"
#include "models/chain/declare.h"
#include "models/median.h"
#include "models/robot_ball/published.h"
#include "models/robot_ball/start.h"
#include "solver/dense.h"
#include "solver/uncertainty/gum.h"
#include "solver/uncertainty/misfit.h"
#include "solver/weigh.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<std::string_view, double, double, double> kOneAxis{
    "robot_ball.one_axis",
    "{}: within each station the flange turns about one axis only, ({:.2f}, {:.2f}, {:.2f}) of its own frame: along it "
    "the hand-eye is not determined; add poses that turn about another",
    "{}: An jeder Station dreht sich der Flansch nur um eine Achse, ({:.2f}; {:.2f}; {:.2f}) in seinem eigenen System: "
    "Längs dieser ist die Hand-Auge-Transformation nicht bestimmt; Posen ergänzen, die um eine andere drehen"};
constexpr Message<std::string_view, size_t, size_t, std::string_view> kStationsOfOnePose{
    "robot_ball.stations_of_one_pose",
    "{}: {} of {} stations were seen from one pose only, which says nothing about robot and hand-eye: {}",
    "{}: {} von {} Stationen wurden nur aus einer Pose gesehen, was nichts über Roboter und Hand-Auge-Transformation "
    "sagt: {}"};
constexpr Message<std::string_view, size_t, size_t, std::string_view> kFewBalls{
    "robot_ball.few_balls", "{}: {} poses saw less than {} balls, too few to place the artifact by themselves: {}",
    "{}: {} Posen sahen weniger als {} Kugeln, zu wenige, um das Normal für sich allein zu verorten: {}"};
constexpr Message<std::string_view, std::string_view, double, double> kPoseOff{
    "robot_ball.pose_off",
    "pose {} of station {} is set aside: it lies {:.2g} mm off, {:.2g} times the median of all poses; check its joint "
    "angles and what was seen from it",
    "Pose {} an Station {} ist ausgesondert: Sie liegt um {:.2g} mm daneben, das {:.2g}-Fache des Medians aller Posen; "
    "Gelenkwinkel und Beobachtungen prüfen"};
constexpr Message<size_t, size_t> kManyOff{
    "robot_ball.many_off",
    "{} of {} poses had to be set aside: that is no exception; check the joint angles, and what was seen",
    "{} von {} Posen mussten ausgesondert werden: Das ist keine Ausnahme; Gelenkwinkel und Beobachtungen prüfen"};
constexpr Message<std::string_view, double, double> kOtherLength{
    "robot_ball.other_length", "check: {}: measured {:.6g} mm, known as {:.6g} mm: another unit, or other balls?",
    "Prüfung: {}: gemessen {:.6g} mm, bekannt als {:.6g} mm: eine andere Einheit oder andere Kugeln?"};
constexpr Message<double, double> kWorseThanNominal{
    "robot_ball.worse_than_nominal",
    "check: the known lengths are off by {:.2g} mm on average, more than with the nominal robot ({:.2g} mm)",
    "Prüfung: Die bekannten Längen weichen im Mittel um {:.2g} mm ab, mehr als mit dem nominellen Roboter ({:.2g} mm)"};

constexpr Message<Sentence, std::string_view, std::string_view, double, double, double, double, std::string_view,
                  double>
    kChanged{
        "robot_ball.changed",
        "{} stands elsewhere from pose {} of station {} on, by {:.2g} mm and {:.2g} rad (F = {:.3g}, p = {:.1g}, "
        "corrected for all poses that were tried), which moves {} by {:.2g} u: was it knocked, or loose? Calibrate "
        "with the poses of one side only",
        "{} steht ab Pose {} an Station {} anders, um {:.2g} mm und {:.2g} rad (F = {:.3g}, p = {:.1g}, korrigiert "
        "für alle geprüften Posen); das verschiebt {} um das {:.2g}-Fache von u: angestoßen oder locker? Nur mit "
        "den Posen einer Seite kalibrieren"};
constexpr Message<> kScannerOnFlange{"robot_ball.scanner_on_flange", "the scanner on its flange",
                                     "Der Scanner an seinem Flansch"};
constexpr Message<> kToolOnFlange{"robot_ball.tool_on_flange", "the tool on its flange",
                                  "Das Werkzeug an seinem Flansch"};
constexpr Message<> kArtifactOrBase{"robot_ball.artifact_or_base", "the artifact (or the base)",
                                    "Das Normal (oder die Basis)"};
constexpr Message<> kTrackerOrBase{"robot_ball.tracker_or_base", "the tracker (or the base)",
                                   "Der Tracker (oder die Basis)"};
constexpr Message<double, double, double> kLengthsOff{
    "robot_ball.lengths_off",
    "check: the known lengths are off by {:.3g} mm rms, {:.2g} times what the uncertainties and the noise explain (p = "
    "{:.1g}): the model lacks something where they were measured, and U does not hold it",
    "Prüfung: Die bekannten Längen weichen um {:.3g} mm (quadratisches Mittel) ab, das {:.2g}-Fache dessen, was "
    "Unsicherheiten und Rauschen erklären (p = {:.1g}): Dem Modell fehlt dort etwas, das U nicht enthält"};
constexpr Message<double, double, double> kLengthsShifted{
    "robot_ball.lengths_shifted",
    "check: the known lengths are off by {:+.3g} mm on average, with a standard uncertainty of {:.2g} mm (p = {:.1g}): "
    "a scale is wrong, or the model lacks something",
    "Prüfung: Die bekannten Längen weichen im Mittel um {:+.3g} mm ab, bei einer Standardunsicherheit von {:.2g} mm (p "
    "= "
    "{:.1g}): Ein Maßstab ist falsch, oder dem Modell fehlt etwas"};

constexpr Message<double, double, double, double> kHeldOutOff{
    "robot_ball.held_out_off",
    "the poses held out are {:.2g} times as far off as u and the noise explain (F = {:.3g}, {:.0f} degrees of freedom, "
    "p = "
    "{:.1g}): the model lacks something there, and U does not hold it",
    "Die zurückgehaltenen Posen liegen um das {:.2g}-Fache dessen daneben, was u und das Rauschen erklären (F = "
    "{:.3g}, "
    "{:.0f} Freiheitsgrade, p = {:.1g}): Dem Modell fehlt dort etwas, das U nicht enthält"};

constexpr size_t kFewestBalls = 3;
constexpr double kLeastTurn_rad = 0.0175;  // one degree, rms

Eigen::Isometry3d FlangeOf(const Measurements& data, const Model::View& view) {
  return data.links.empty() ? view.base_from_flange : BaseFromFlange(data.links, view.joints);
}

Result<void> CheckReach(const Measurements& data, const std::string& where) {
  if (!data.links.empty()) return {};
  double reach = 0;
  for (const Station& station : data.stations)
    for (const Model::View& view : station.views) reach = std::max(reach, view.base_from_flange.translation().norm());
  if (reach >= kLeastReach_mm && reach <= kLargestReach_mm) return {};
  return Error{
      fmt::format("{}: the flange comes {:.3g} mm away from the base, expected {} mm to {} mm; see units: length, "
                  "or name the columns x_mm, x_m or x_um",
                  where, reach, kLeastReach_mm, kLargestReach_mm)};
}

// What the poses of each station turn v by, rms over the poses: singular values of (R_i - R_1) v.
Result<void> CheckTurns(const Measurements& data, const std::string& where, std::vector<Sentence>* warnings) {
  if (data.hand_eye) return {};  // nothing is left open
  std::vector<Eigen::Matrix3d> turns;
  for (const Station& station : data.stations) {
    const Eigen::Matrix3d first = FlangeOf(data, station.views.front()).linear();
    for (size_t k = 1; k < station.views.size(); ++k)
      turns.push_back(FlangeOf(data, station.views[k]).linear() - first);
  }
  Eigen::MatrixXd rows(3 * std::ssize(turns), 3);
  for (size_t k = 0; k < turns.size(); ++k) rows.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = turns[k];
  const Svd svd = SvdOf(rows);
  const Eigen::Vector3d turn = svd.values / std::sqrt(static_cast<double>(turns.size()));
  if (turn[0] < kLeastTurn_rad)
    return Error{
        fmt::format("{}: within each station the flange turns by {:.2g} deg only, which leaves the translation "
                    "of the hand-eye open; expected poses that turn about two axes, by tens of degrees",
                    where, turn[0] / kDegree)};
  if (turn[2] < kLeastTurn_rad) {
    const Eigen::Vector3d axis = svd.v.col(2);
    warnings->push_back(Say(kOneAxis, where, axis[0], axis[1], axis[2]));
  }
  return {};
}

Result<void> CheckStations(const Measurements& data, const std::string& where, std::vector<Sentence>* warnings) {
  std::vector<std::string> once, few;
  for (const Station& station : data.stations) {
    std::set<int> balls;
    for (const Model::View& view : station.views) {
      for (const Model::SeenBall& ball : view.balls) balls.insert(ball.sphere);
      if (view.balls.size() < std::min(kFewestBalls, data.spheres.size())) few.push_back(view.name);
    }
    if (balls.size() < std::min(kFewestBalls, data.spheres.size()))
      return Error{
          fmt::format("{}: all poses of station {} together saw {} of the balls, expected {} or more: the pose "
                      "of the artifact is not determined; add balls, or remove the station",
                      where, Quoted(station.name), balls.size(), kFewestBalls)};
    if (station.views.size() == 1) once.push_back(station.name);
  }
  if (once.size() == data.stations.size())
    return Error{where +
                 ": every station was seen from one pose only, expected two or more: one pose says where the "
                 "artifact is, and nothing about robot and hand-eye"};
  if (!once.empty())
    warnings->push_back(Say(kStationsOfOnePose, where, once.size(), data.stations.size(), Listed(once)));
  if (!few.empty()) warnings->push_back(Say(kFewBalls, where, few.size(), kFewestBalls, Listed(few)));
  return {};
}

using Labels = std::vector<int>;  // the sphere that each ball of a pose is said to be

constexpr double kScale = 2e-3;       // a scanner's own error of scale stays below it
constexpr double kSameFactor = 0.02;  // of units
constexpr double kFifth = 0.2533;     // a fifth of a normal distribution lies within so many standard deviations

class BallNames {
 public:
  explicit BallNames(const Measurements& data) : data_(data) {
    std::vector<double> errors;
    for (const Station& station : data.stations)
      for (const Model::View& view : station.views) Collect(view, &errors);
    ratio_ = Median(ratios_);
    if (errors.empty()) return;
    const auto fifth = errors.begin() + std::ssize(errors) / 5;
    std::nth_element(errors.begin(), fifth, errors.end());
    noise_ = *fifth / kFifth;
  }

  std::optional<WrongBall> Run() const {
    if (ratios_.empty()) return std::nullopt;
    if (const std::string sentence = AnotherUnit(); !sentence.empty()) return WrongBall{"", "", sentence};
    std::optional<WrongBall> first;
    int poses = 0;
    for (const Station& station : data_.stations)
      for (const Model::View& view : station.views) {
        if (CountOff(view, LabelsOf(view)).empty()) continue;
        ++poses;
        if (!first) first = Name(view);
      }
    if (first && poses > 1) first->sentence += fmt::format("; {} poses have such a ball", poses);
    if (!first && AreMirrored()) return WrongBall{"", "", kMirrored};
    return first;
  }

 private:
  static constexpr const char* kMirrored =
      "the balls are the mirror image of the artifact, expected two right-handed frames; is the sign or the order of "
      "the axes right?";

  double Nominal(int a, int b) const {
    const auto& spheres = data_.spheres;
    return (spheres[static_cast<size_t>(a)].centre - spheres[static_cast<size_t>(b)].centre).norm();
  }
  static double Measured(const Model::View& view, size_t i, size_t j) {
    return (view.balls[i].centre - view.balls[j].centre).norm();
  }
  static Labels LabelsOf(const Model::View& view) {
    Labels labels;
    for (const Model::SeenBall& ball : view.balls) labels.push_back(ball.sphere);
    return labels;
  }
  std::string NameOf(int sphere) const { return Quoted(data_.spheres[static_cast<size_t>(sphere)].name); }

  void Collect(const Model::View& view, std::vector<double>* errors) {
    for (size_t i = 0; i < view.balls.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const double nominal = Nominal(view.balls[i].sphere, view.balls[j].sphere), measured = Measured(view, i, j);
        ratios_.push_back(measured / nominal);
        errors->push_back(std::abs(measured - nominal));
      }
  }

  std::string AnotherUnit() const {
    for (const double factor : {1e3, 1e6, 10.0, 100.0, 25.4, 304.8})
      for (const double times : {factor, 1 / factor})
        if (std::abs(ratio_ / times - 1) < kSameFactor)
          return fmt::format(
              "the balls lie {:.4g} times as far apart as the artifact's, expected the same distances; "
              "see units: length, or name the columns x_mm, x_m or x_um",
              times);
    return "";
  }

  // How many distances of each ball are off; empty: those of no ball are.
  std::vector<int> CountOff(const Model::View& view, const Labels& labels) const {
    std::vector<int> off(labels.size());
    bool any = false;
    for (size_t i = 0; i < labels.size(); ++i)
      for (size_t j = 0; j < i; ++j) {
        const double nominal = Nominal(labels[i], labels[j]);
        if (std::abs(Measured(view, i, j) - nominal) <= std::max(kOffNoises * noise_, kScale * nominal)) continue;
        any = true;
        ++off[i];
        ++off[j];
      }
    return any ? off : std::vector<int>();
  }

  WrongBall Name(const Model::View& view) const {
    const Labels labels = LabelsOf(view);
    const std::vector<int> off = CountOff(view, labels);
    const auto worst = static_cast<size_t>(std::max_element(off.begin(), off.end()) - off.begin());
    double furthest = 0;
    for (size_t j = 0; j < labels.size(); ++j)
      if (j != worst)
        furthest = std::max(furthest, std::abs(Measured(view, worst, j) - Nominal(labels[worst], labels[j])));
    const std::string sentence =
        fmt::format("in pose {} {} of its {} distances to other balls disagree with the artifact, by up to {:.3g} mm",
                    Quoted(view.name), off[worst], labels.size() - 1, furthest);
    const auto wrong = [&](size_t ball, const std::string& hint) {
      return WrongBall{view.name, data_.spheres[static_cast<size_t>(labels[ball])].name, sentence + hint};
    };
    for (size_t i = 0; i < labels.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        Labels swapped = labels;
        std::swap(swapped[i], swapped[j]);
        if (CountOff(view, swapped).empty())
          return wrong(i, "; are " + NameOf(labels[i]) + " and " + NameOf(labels[j]) + " exchanged?");
      }
      for (int sphere = 0; sphere < static_cast<int>(data_.spheres.size()); ++sphere) {
        if (std::find(labels.begin(), labels.end(), sphere) != labels.end()) continue;
        Labels renamed = labels;
        renamed[i] = sphere;
        if (CountOff(view, renamed).empty()) return wrong(i, "; is it " + NameOf(sphere) + "?");
      }
    }
    return wrong(worst, "; give the name that it has, or remove the line");
  }

  // Most poses that show it: of four balls and more that lie in no plane.
  bool AreMirrored() const {
    constexpr double kFlat = 0.05;
    int mirrored = 0, poses = 0;
    for (const Station& station : data_.stations)
      for (const Model::View& view : station.views) {
        Eigen::Matrix3Xd seen(3, std::ssize(view.balls)), known = seen;
        for (size_t i = 0; i < view.balls.size(); ++i) {
          seen.col(static_cast<Eigen::Index>(i)) = view.balls[i].centre;
          known.col(static_cast<Eigen::Index>(i)) = data_.spheres[static_cast<size_t>(view.balls[i].sphere)].centre;
        }
        if (seen.cols() < 4) continue;
        seen.colwise() -= seen.rowwise().mean().eval();
        known.colwise() -= known.rowwise().mean().eval();
        const Eigen::Matrix3d product = seen * known.transpose();
        const Eigen::Vector3d singular = SvdOf(product).values;
        if (singular[2] < kFlat * kFlat * singular[0]) continue;
        ++poses;
        mirrored += product.determinant() < 0;
      }
    return 2 * mirrored > poses;
  }

  const Measurements& data_;
  std::vector<double> ratios_;
  double ratio_ = 1, noise_ = 0;
};

constexpr double kGross = 5;           // times the median of all poses: noise of a few balls reaches two
constexpr double kMostSetAside = 0.1;  // of the poses
constexpr double kOtherUnit = 0.1;

struct OffPose {
  size_t station, view;
  double rms = 0;  // mm, of its balls from the artifact
};

std::vector<OffPose> ByPose(const Measurements& data, const JointFit& fit) {
  const Kinematics setup = fit.Found();
  std::vector<OffPose> poses;
  for (size_t t = 0; t < data.stations.size(); ++t) {
    const Eigen::Isometry3d base_from_artifact = fit.BaseFromArtifact(t);
    for (size_t v = 0; v < data.stations[t].views.size(); ++v) {
      const Model::View& pose = data.stations[t].views[v];
      const Eigen::Isometry3d base_from_tool = BaseFromScanner(data, setup, pose);
      double squares = 0;
      for (const Model::SeenBall& ball : pose.balls)
        squares += (base_from_tool * data.OnTool(ball) - base_from_artifact * data.InWorld(ball)).squaredNorm();
      poses.push_back({t, v, std::sqrt(squares / static_cast<double>(std::max<size_t>(1, pose.balls.size())))});
    }
  }
  return poses;
}

// Poses far from where all others put them. One bad pose pulls its neighbours with it: those nearer than half of the
// worst wait until it is gone. Each is named.
std::vector<OffPose> SetAside(const Measurements& data, const JointFit& fit, std::vector<Sentence>* warnings) {
  constexpr double kRounding_mm = 1e-5;
  std::vector<OffPose> poses = ByPose(data, fit);
  std::vector<double> all;
  for (const OffPose& pose : poses) all.push_back(pose.rms);
  const double usual = std::max(Median(all), kRounding_mm);
  std::erase_if(poses, [&](const OffPose& pose) { return pose.rms <= kGross * usual; });
  std::stable_sort(poses.begin(), poses.end(), [](const OffPose& a, const OffPose& b) { return a.rms > b.rms; });
  std::erase_if(
      poses, [&, worst = poses.empty() ? 0 : poses.front().rms](const OffPose& pose) { return pose.rms < worst / 2; });
  for (const OffPose& pose : poses)
    warnings->push_back(Say(kPoseOff, data.stations[pose.station].views[pose.view].name,
                            data.stations[pose.station].name, pose.rms, pose.rms / usual));
  return poses;
}

// A scanner that slipped in its mount, or an artifact that was pushed at its station (or the base, after which all
// stations are new).
void JudgeChange(const ScreenedFit& fitted, Calibration* result) {
  using Order = std::vector<std::pair<size_t, size_t>>;
  const Solution& solution = fitted.fit.solution;
  const auto number = [&](const std::pair<size_t, size_t>& at) {
    return fitted.data.stations[at.first].views[at.second].number;
  };
  const auto by_number = [&](const auto& a, const auto& b) { return number(a) < number(b); };
  const auto six_from = [&](int first) {
    std::vector<int> six(6);
    for (int k = 0; k < 6; ++k) six[static_cast<size_t>(k)] = first + k;
    return six;
  };
  const auto find = [&](const Order& order, int first) {
    return FindChange(solution.problem, solution.fit.estimate, solution.linear, result->noise_dof, order,
                      six_from(first));
  };
  Order all, order;
  Change best;
  for (size_t t = 0; t < fitted.data.stations.size(); ++t) {
    Order own;
    for (size_t v = 0; v < fitted.data.stations[t].views.size(); ++v) own.push_back({t, v});
    all.insert(all.end(), own.begin(), own.end());
    std::stable_sort(own.begin(), own.end(), by_number);
    Change change = find(own, Model::kArtifact);
    change.p = std::min(1.0, change.p * static_cast<double>(fitted.data.stations.size()));
    if (change.p >= best.p) continue;
    best = std::move(change);
    order = own;
  }
  std::stable_sort(all.begin(), all.end(), by_number);
  Change of_tool = find(all, Model::kHandEye);
  const bool is_tool = of_tool.p <= best.p;
  if (is_tool) {
    best = std::move(of_tool);
    order = all;
  }
  best.p = std::min(1.0, 2 * best.p);
  if (best.p >= kSuspicious) return;
  const auto [which, furthest] = Furthest(best.moves, *result);
  const auto length = [&](size_t first) {
    return std::hypot(best.size[first], best.size[first + 1], best.size[first + 2]);
  };
  const auto& [t, v] = order[best.place];
  (furthest > 1 ? result->unreliable : result->warnings)
      .push_back(Say(kChanged,
                     fitted.data.measured_in_world ? (is_tool ? Say(kToolOnFlange) : Say(kTrackerOrBase))
                                                   : (is_tool ? Say(kScannerOnFlange) : Say(kArtifactOrBase)),
                     fitted.data.stations[t].views[v].name, fitted.data.stations[t].name, length(0), length(3), best.F,
                     best.p, which, furthest));
}

// Of the check lengths: what u, the noise of two poses and the lengths' own uncertainty make of their errors.
Eigen::MatrixXd CovarianceOfCheck(const ScreenedFit& fitted, const Calibration& result) {
  const Measurements& data = fitted.data;
  const Problem& problem = fitted.fit.solution.problem;
  const std::vector<double> found = Values(problem, fitted.fit.solution.fit.estimate, 0);
  const std::vector<int> estimated = problem.With({Scope::kSystem}, Role::kEstimate);
  const auto errors = [&](const std::vector<double>& values) {
    const std::vector<double> each = SpacingErrors(data, KinematicsOf(values, data.links.size()));
    return Eigen::VectorXd(Eigen::VectorXd::Map(each.data(), std::ssize(each)));
  };
  Eigen::MatrixXd sensitivity(std::ssize(data.check), std::ssize(estimated));
  for (size_t k = 0; k < estimated.size(); ++k) {
    const double step = result.Find(problem.quantities[estimated[k]].name)->u;
    std::vector<double> above = found, below = found;
    above[estimated[k]] += step;
    below[estimated[k]] -= step;
    sensitivity.col(static_cast<Eigen::Index>(k)) = (errors(above) - errors(below)) / (2 * step);
  }
  Eigen::MatrixXd covariance = PropagateCovariance(sensitivity, result.covariance);
  const auto variance = [&](int quantity) { return std::pow(problem.quantities[quantity].u, 2); };
  const Kinematics setup = fitted.fit.Found();
  for (size_t k = 0; k < data.check.size(); ++k) {
    const CheckLength& check = data.check[k];
    const Eigen::Vector3d ball[2] = {check.first_pose.balls[0].centre, check.second_pose.balls[0].centre};
    const Eigen::Isometry3d base_from_tool[2] = {BaseFromScanner(data, setup, check.first_pose),
                                                 BaseFromScanner(data, setup, check.second_pose)};
    const Eigen::Vector3d along = (base_from_tool[0] * ball[0] - base_from_tool[1] * ball[1]).normalized();
    double noise = check.u * check.u + 2 * variance(Model::kBall);
    for (int pose = 0; pose < 2 && check.first_pose.name != check.second_pose.name; ++pose) {
      const Eigen::Vector3d arm = base_from_tool[pose].linear() * (setup.flange_from_scanner * ball[pose]);
      noise += variance(Model::kRepeatability) + variance(Model::kRepeatability + 3) * arm.cross(along).squaredNorm();
    }
    covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) += noise;
  }
  return covariance;
}

// Poses that took no part, their artifact placed by them.
void JudgeHeldOut(const ScreenedFit& fitted, Calibration* result) {
  if (fitted.data.held_out.empty() || !(result->noise_dof >= 1)) return;
  const Solution& solution = fitted.fit.solution;
  Measurements data = fitted.data;
  data.stations = data.held_out;
  const auto placed = StationsAt(data, fitted.fit.Found());
  if (!placed.ok()) return;
  Model model(data.links, data.spheres, data.measured_in_world);
  for (size_t k = 0; k < solution.problem.quantities.size(); ++k)
    model.quantity(static_cast<int>(k)) = solution.problem.quantities[k];
  Problem problem = MakeProblem<Model>(std::make_shared<const Model>(model), *placed);
  Estimate at = NominalStart(problem);
  at.system = solution.fit.estimate.system;
  Weigh(&problem, at);
  const HeldOutTest test = TestHeldOut(problem, at, result->covariance, result->noise_dof);
  if (test.Contradicts()) result->unreliable.push_back(Say(kHeldOutOff, std::sqrt(test.F), test.F, test.dof1, test.p));
}

void JudgeCheck(const ScreenedFit& fitted, Calibration* result) {
  const Measurements& data = fitted.data;
  const LengthCheck& check = result->check;
  if (check.after.empty()) return;
  for (size_t k = 0; k < data.check.size(); ++k) {
    if (std::abs(check.after[k]) <= kOtherUnit * data.check[k].distance) continue;
    result->unreliable.push_back(
        Say(kOtherLength, check.names[k].english, data.check[k].distance + check.after[k], data.check[k].distance));
    return;
  }
  const double before = SizeOfErrors(check.before).mean, after = SizeOfErrors(check.after).mean;
  const auto errors = Eigen::VectorXd::Map(check.after.data(), std::ssize(check.after));
  const double n = static_cast<double>(check.after.size());
  constexpr double kWorse = 0.01;
  // By more than chance: a robot whose nominal links are good already becomes worse in every second calibration.
  const double nominal = Eigen::VectorXd::Map(check.before.data(), std::ssize(check.before)).squaredNorm();
  if (after > before && FUpperTail(errors.squaredNorm() / nominal, n, n) < kWorse)
    result->unreliable.push_back(Say(kWorseThanNominal, after, before));
  if (!(result->noise_dof >= 1) || data.check.empty()) return;
  const Eigen::MatrixXd covariance = CovarianceOfCheck(fitted, *result);
  const double F = Cholesky(covariance).SolveLower(errors).squaredNorm() / n, mean = errors.mean(),
               u_mean = std::sqrt(covariance.sum()) / n, p = 2 * FUpperTail(F, n, result->noise_dof),
               p_mean = 2 * FUpperTail(std::pow(mean / u_mean, 2), 1, result->noise_dof);
  if (p < kSuspicious && std::sqrt(F) > HeldOutTest::kMore)
    result->unreliable.push_back(Say(kLengthsOff, std::sqrt(errors.squaredNorm() / n), std::sqrt(F), std::min(1.0, p)));
  if (p_mean < kSuspicious) result->unreliable.push_back(Say(kLengthsShifted, mean, u_mean, std::min(1.0, p_mean)));
}

}  // namespace

Result<void> CheckPoses(const Measurements& data, const std::string& where, std::vector<Sentence>* warnings) {
  SCANCAL_RETURN_IF_ERROR(CheckReach(data, where));
  SCANCAL_RETURN_IF_ERROR(CheckStations(data, where, warnings));
  return CheckTurns(data, where, warnings);
}

std::optional<WrongBall> FindWrongBall(const Measurements& data) { return BallNames(data).Run(); }

Result<ScreenedFit> FitScreened(const Measurements& data, const Model& model, int max_iterations, bool equal_weights) {
  constexpr int kRounds = 6;
  SCANCAL_ASSIGN_OR_RETURN(Screened screened, Screen(data));
  ScreenedFit result{std::move(screened.data), {}, std::move(screened.warnings), 0};
  const auto count = [](const Measurements& of) {
    size_t poses = 0;
    for (const Station& station : of.stations) poses += station.views.size();
    return poses;
  };
  for (int round = 0;; ++round) {
    SCANCAL_ASSIGN_OR_RETURN(result.fit,
                             FitJointly(result.data, model, screened.hand_eye, max_iterations, equal_weights));
    result.set_aside = count(data) - count(result.data);
    if (round == kRounds) break;
    std::vector<OffPose> off = SetAside(result.data, result.fit, &result.warnings);
    if (off.empty()) break;
    std::sort(off.begin(), off.end(), [](const OffPose& a, const OffPose& b) {
      return std::pair(a.station, a.view) > std::pair(b.station, b.view);
    });
    for (const OffPose& pose : off) {
      std::vector<Model::View>& views = result.data.stations[pose.station].views;
      views.erase(views.begin() + static_cast<std::ptrdiff_t>(pose.view));
    }
    std::erase_if(result.data.stations, [](const Station& station) { return station.views.empty(); });
  }
  return result;
}

void Judge(const ScreenedFit& fitted, Calibration* result) {
  size_t poses = fitted.set_aside;
  for (const Station& station : fitted.data.stations) poses += station.views.size();
  if (static_cast<double>(fitted.set_aside) > kMostSetAside * static_cast<double>(poses))
    result->unreliable.push_back(Say(kManyOff, fitted.set_aside, poses));
  JudgeChange(fitted, result);
  JudgeCheck(fitted, result);
  JudgeHeldOut(fitted, result);
}

}  // namespace scancal::robot_ball

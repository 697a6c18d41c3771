#include "models/robot_ball/judge.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <set>
#include "io/message.h"
#include "io/units.h"
#include "models/chain/declare.h"
#include "models/median.h"
#include "models/robot_ball/start.h"
#include "solver/dense.h"

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
    "pose {} of station {}: its balls lie {:.2g} mm off, {:.2g} times the median of all poses; check its joint angles "
    "and balls, or leave it out",
    "Pose {} an Station {}: Ihre Kugeln liegen um {:.2g} mm daneben, das {:.2g}-Fache des Medians aller Posen; "
    "Gelenkwinkel und Kugeln prüfen oder die Pose weglassen"};
constexpr Message<std::string_view, double, double> kOtherLength{
    "robot_ball.other_length", "check: {}: measured {:.6g} mm, known as {:.6g} mm: another unit, or other balls?",
    "Prüfung: {}: gemessen {:.6g} mm, bekannt als {:.6g} mm: eine andere Einheit oder andere Kugeln?"};
constexpr Message<double, double> kWorseThanNominal{
    "robot_ball.worse_than_nominal",
    "check: the known lengths are off by {:.2g} mm on average, more than with the nominal robot ({:.2g} mm)",
    "Prüfung: Die bekannten Längen weichen im Mittel um {:.2g} mm ab, mehr als mit dem nominellen Roboter ({:.2g} mm)"};

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
      if (view.balls.size() < kFewestBalls) few.push_back(view.name);
    }
    if (balls.size() < kFewestBalls)
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

constexpr double kGross = 5;  // times the median of all poses: noise of a few balls reaches two
constexpr size_t kNamed = 3;  // poses
constexpr double kOtherUnit = 0.1;

struct OffPose {
  std::string station, pose;
  double rms = 0;  // mm, of its balls from the artifact
};

std::vector<OffPose> ByPose(const Measurements& data, const JointFit& fit) {
  const Kinematics setup = fit.Found();
  std::vector<OffPose> poses;
  for (size_t t = 0; t < data.stations.size(); ++t) {
    const Eigen::Isometry3d base_from_artifact = fit.BaseFromArtifact(t);
    for (const Model::View& pose : data.stations[t].views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      double squares = 0;
      for (const Model::SeenBall& ball : pose.balls)
        squares +=
            (base_from_scanner * ball.centre - base_from_artifact * data.spheres[ball.sphere].centre).squaredNorm();
      poses.push_back({data.stations[t].name, pose.name,
                       std::sqrt(squares / static_cast<double>(std::max<size_t>(1, pose.balls.size())))});
    }
  }
  return poses;
}

void JudgePoses(const Measurements& data, const JointFit& fit, Calibration* result) {
  constexpr double kRounding_mm = 1e-5;
  std::vector<OffPose> poses = ByPose(data, fit);
  std::vector<double> all;
  for (const OffPose& pose : poses) all.push_back(pose.rms);
  const double usual = std::max(Median(all), kRounding_mm);
  std::erase_if(poses, [&](const OffPose& pose) { return pose.rms <= kGross * usual; });
  std::sort(poses.begin(), poses.end(), [](const OffPose& a, const OffPose& b) { return a.rms > b.rms; });
  // One bad pose pulls its neighbours with it.
  std::erase_if(
      poses, [&, worst = poses.empty() ? 0 : poses.front().rms](const OffPose& pose) { return pose.rms < worst / 2; });
  for (size_t k = 0; k < poses.size() && k < kNamed; ++k)
    result->unreliable.push_back(Say(kPoseOff, poses[k].pose, poses[k].station, poses[k].rms, poses[k].rms / usual));
}

void JudgeCheck(const Measurements& data, Calibration* result) {
  const LengthCheck& check = result->check;
  for (size_t k = 0; k < check.after.size(); ++k) {
    if (std::abs(check.after[k]) <= kOtherUnit * data.check[k].distance) continue;
    result->unreliable.push_back(
        Say(kOtherLength, check.names[k].english, data.check[k].distance + check.after[k], data.check[k].distance));
    return;
  }
  const double before = SizeOfErrors(check.before).mean, after = SizeOfErrors(check.after).mean;
  if (after > before) result->unreliable.push_back(Say(kWorseThanNominal, after, before));
}

}  // namespace

Result<void> CheckPoses(const Measurements& data, const std::string& where, std::vector<Sentence>* warnings) {
  SCANCAL_RETURN_IF_ERROR(CheckReach(data, where));
  SCANCAL_RETURN_IF_ERROR(CheckStations(data, where, warnings));
  return CheckTurns(data, where, warnings);
}

std::optional<WrongBall> FindWrongBall(const Measurements& data) { return BallNames(data).Run(); }

void Judge(const Measurements& data, const JointFit& fit, Calibration* result) {
  JudgePoses(data, fit, result);
  JudgeCheck(data, result);
}

}  // namespace scancal::robot_ball

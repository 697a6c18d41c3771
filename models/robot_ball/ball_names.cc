#include "models/robot_ball/ball_names.h"
#include <fmt/format.h>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "models/parts/median.h"

namespace scancal {
namespace {

using Labels = std::vector<int>;  // the sphere that each ball of a pose is said to be

constexpr double kScale = 2e-3;       // a scanner's own error of scale stays below it
constexpr double kSameFactor = 0.02;  // of units
constexpr double kFifth = 0.2533;     // a fifth of a normal distribution lies within so many standard deviations

class Judge {
 public:
  explicit Judge(const RobotData& data) : data_(data) {
    std::vector<double> errors;
    for (const Station& station : data.stations)
      for (const RobotBall::View& view : station.views) Collect(view, &errors);
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
      for (const RobotBall::View& view : station.views) {
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
  static double Measured(const RobotBall::View& view, size_t i, size_t j) {
    return (view.balls[i].centre - view.balls[j].centre).norm();
  }
  static Labels LabelsOf(const RobotBall::View& view) {
    Labels labels;
    for (const RobotBall::SeenBall& ball : view.balls) labels.push_back(ball.sphere);
    return labels;
  }
  std::string NameOf(int sphere) const { return Quoted(data_.spheres[static_cast<size_t>(sphere)].name); }

  void Collect(const RobotBall::View& view, std::vector<double>* errors) {
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
  std::vector<int> CountOff(const RobotBall::View& view, const Labels& labels) const {
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

  WrongBall Name(const RobotBall::View& view) const {
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
      for (const RobotBall::View& view : station.views) {
        Eigen::Matrix3Xd seen(3, std::ssize(view.balls)), known = seen;
        for (size_t i = 0; i < view.balls.size(); ++i) {
          seen.col(static_cast<Eigen::Index>(i)) = view.balls[i].centre;
          known.col(static_cast<Eigen::Index>(i)) = data_.spheres[static_cast<size_t>(view.balls[i].sphere)].centre;
        }
        if (seen.cols() < 4) continue;
        seen.colwise() -= seen.rowwise().mean().eval();
        known.colwise() -= known.rowwise().mean().eval();
        const Eigen::Matrix3d product = seen * known.transpose();
        const Eigen::Vector3d singular = product.jacobiSvd().singularValues();
        if (singular[2] < kFlat * kFlat * singular[0]) continue;
        ++poses;
        mirrored += product.determinant() < 0;
      }
    return 2 * mirrored > poses;
  }

  const RobotData& data_;
  std::vector<double> ratios_;
  double ratio_ = 1, noise_ = 0;
};

}  // namespace

std::optional<WrongBall> FindWrongBall(const RobotData& data) { return Judge(data).Run(); }

}  // namespace scancal

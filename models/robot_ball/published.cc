// The methods on the same robot (Zhou et al. 2025, Table 4 and Figure 8).
#include "models/robot_ball/published.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include "io/progress.h"
#include "models/robot_ball/judge.h"
#include "models/robot_ball/scanner.h"
#include "models/robot_ball/start.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

constexpr Message<> kNominalRobot{"robot_ball.nominal_robot", "nominal robot, first hand-eye",
                                  "nomineller Roboter, erste Hand-Auge"};
constexpr Message<> kRen2012{"robot_ball.ren2012", "Ren 2012, single sphere", "Ren 2012, einzelne Kugel"};
constexpr Message<> kMu2017{"robot_ball.mu2017", "Mu 2017, distances", "Mu 2017, Abstände"};
constexpr Message<> kZhou2025{"robot_ball.zhou2025", "Zhou 2025, corrected distances",
                              "Zhou 2025, korrigierte Abstände"};
constexpr Message<> kJoint{"robot_ball.joint", "joint refinement", "gemeinsame Ausgleichung"};
constexpr Message<std::string_view> kLeftOut{"robot_ball.left_out", "left out: {}", "weggelassen: {}"};

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;
using SeenBall = Model::SeenBall;
using View = Model::View;

constexpr size_t kBallsOfThePoint = 4;

bool Sees(const View& view, int sphere) {
  return std::ranges::any_of(view.balls, [&](const SeenBall& ball) { return ball.sphere == sphere; });
}

int MostSeen(const std::vector<View>& views, size_t spheres) {
  std::vector<int> seen(spheres);
  for (const View& view : views)
    for (const SeenBall& ball : view.balls) ++seen[ball.sphere];
  return static_cast<int>(std::ranges::max_element(seen) - seen.begin());
}

std::vector<int> SeenInAll(const std::vector<View>& views, size_t spheres) {
  std::vector<int> common;
  for (int k = 0; k < static_cast<int>(spheres) && common.size() < kBallsOfThePoint; ++k)
    if (std::ranges::all_of(views, [&](const View& view) { return Sees(view, k); })) common.push_back(k);
  return common;
}

Vector3d Barycentre(const View& view, const std::vector<int>& of) {
  Vector3d sum = Vector3d::Zero();
  for (const SeenBall& ball : view.balls)
    if (std::ranges::find(of, ball.sphere) != of.end()) sum += ball.centre;
  return sum / static_cast<double>(of.size());
}

// The poses that see one point, with it alone; they leave `views`.
std::vector<View> TakeOnePoint(std::vector<View>* views, size_t spheres) {
  std::vector<View> taken = *views;
  if (SeenInAll(taken, spheres).empty())
    std::erase_if(taken, [most = MostSeen(taken, spheres)](const View& view) { return !Sees(view, most); });
  const std::vector<int> common = SeenInAll(taken, spheres);
  std::erase_if(*views, [&](const View& view) { return Sees(view, common[0]); });
  for (View& view : taken) view.balls = {{0, Barycentre(view, common)}};
  return taken;
}

struct Move {  // of the flange, and of the point as the scanner sees it
  Vector3d flange = Vector3d::Zero(), point = Vector3d::Zero();
};

// The poses from `first` on that have its orientation; they leave `poses`.
std::vector<Move> TakeTranslating(const Measurements& data, std::vector<View>* poses) {
  constexpr double kSameOrientation_rad = 1e-4;
  const Isometry3d first = BaseFromScanner(data, {}, poses->front());
  std::vector<Move> moves;
  std::erase_if(*poses, [&](const View& view) {
    const Isometry3d flange = BaseFromScanner(data, {}, view);
    const bool same = Eigen::AngleAxisd(first.linear().transpose() * flange.linear()).angle() < kSameOrientation_rad;
    if (same) moves.push_back({-(first.linear().transpose() * flange.translation()), view.balls[0].centre});
    return same;
  });
  Move mean;
  for (const Move& move : moves) mean.flange += move.flange, mean.point += move.point;
  for (Move& move : moves) {
    move.flange -= mean.flange / static_cast<double>(moves.size());
    move.point -= mean.point / static_cast<double>(moves.size());
  }
  return moves;
}

// Eq. (7); none if no poses translate in two directions.
std::optional<Matrix3d> RotationOfTranslating(const Measurements& points) {
  Matrix3d sum = Matrix3d::Zero();
  for (const Station& station : points.stations)
    for (std::vector<View> left = station.views; !left.empty();)
      for (const Move& move : TakeTranslating(points, &left)) sum += move.flange * move.point.transpose();
  const Svd svd = SvdOf(sum);
  const Vector3d sigma = svd.values;
  constexpr double kAlongOneLine = 1e-4;  // squared moves: a hundredth of the largest
  if (sigma[0] == 0 || sigma[1] < kAlongOneLine * sigma[0]) return std::nullopt;
  const Matrix3d u = svd.u, v = svd.v;
  return u * Vector3d(1, 1, u.determinant() * v.determinant()).asDiagonal() * v.transpose();
}

Station OnlySphere(Station station, int sphere) {
  for (View& view : station.views)
    std::erase_if(view.balls, [&](const Model::SeenBall& ball) { return ball.sphere != sphere; });
  std::erase_if(station.views, [](const View& view) { return view.balls.empty(); });
  return station;
}

Station MostSeenSphere(const Measurements& data) {
  Station most;
  for (const Station& station : data.stations)
    for (int k = 0; k < std::ssize(data.spheres); ++k)
      if (Station one = OnlySphere(station, k); one.views.size() > most.views.size()) most = std::move(one);
  return most;
}

constexpr size_t kMostPositions = 12;  // that fit into a line

struct Method {
  Sentence name;
  std::function<Result<Kinematics>()> find;
};

// Distance of the balls from where the artifact of their station puts them, once every station stands at its best.
Result<double> Misclosure(const Measurements& data, const Kinematics& setup) {
  SCANCAL_ASSIGN_OR_RETURN(const std::vector<Station> stations, StationsAt(data, setup));
  double squares = 0, count = 0;
  for (const Station& station : stations) {
    for (const Model::View& pose : station.views) {
      const Eigen::Isometry3d base_from_scanner = BaseFromScanner(data, setup, pose);
      for (const Model::SeenBall& ball : pose.balls) {
        squares += (base_from_scanner * ball.centre - station.base_from_artifact * data.spheres[ball.sphere].centre)
                       .squaredNorm();
        ++count;
      }
    }
  }
  return std::sqrt(squares / count);
}

ComparisonRow RowOf(const Measurements& data, const Method& method) {
  ComparisonRow row{method.name, {}, {}};
  Progress progress(method.name);
  const Stopwatch watch;
  const Result<Kinematics> setup = method.find();
  const double seconds = watch.Seconds();
  const Result<double> misclosure = setup.ok() ? Misclosure(data, *setup) : Result<double>(setup.error());
  if (!misclosure.ok()) {
    row.note = Say(kLeftOut, misclosure.error().message);
    return row;
  }
  if (!data.check.empty()) {
    const std::vector<double> errors = SpacingErrors(data, *setup);
    const ErrorSize size = SizeOfErrors(errors);
    row.cells = {{size.max}, {size.mean}};
    for (size_t k = 0; k < errors.size() && k < kMostPositions; ++k) row.cells.push_back({errors[k]});
  }
  row.cells.push_back({*misclosure});
  row.cells.push_back({seconds});
  return row;
}

}  // namespace

Measurements VirtualPoints(const Measurements& data) {
  Measurements points = data;
  points.spheres = {{"virtual point", Vector3d::Zero()}};
  points.check.clear();
  points.stations.clear();
  for (const Station& station : data.stations) {
    std::vector<View> left = station.views;
    std::erase_if(left, [](const View& view) { return view.balls.empty(); });
    while (!left.empty()) points.stations.push_back({station.name, TakeOnePoint(&left, std::ssize(data.spheres)), {}});
  }
  return points;
}

Result<Kinematics> VirtualPointHandEye(const Measurements& data) {
  const Measurements points = VirtualPoints(data);
  const std::optional<Matrix3d> rotation = RotationOfTranslating(points);
  if (!rotation) return InitialHandEye(data);
  Kinematics setup;
  setup.flange_from_scanner.linear() = *rotation;
  SCANCAL_ASSIGN_OR_RETURN(setup.flange_from_scanner.translation(), HandEyeTranslation(points, *rotation));
  setup.link_errors.resize(data.links.size());
  return setup;
}

Result<Kinematics> Ren2012(const Measurements& data) {
  Measurements one = data;
  one.stations = {MostSeenSphere(data)};
  Result<Kinematics> first = VirtualPointHandEye(one);
  if (!first.ok()) first = InitialHandEye(data);
  if (!first.ok()) return first;
  return IdentifyByDistances(one, *first, Identified::kHandEye);
}

Result<Kinematics> Mu2017(const Measurements& data) {
  SCANCAL_ASSIGN_OR_RETURN(const Kinematics first, VirtualPointHandEye(data));
  return IdentifyByDistances(data, first, Identified::kHandEyeAndLinks);
}

Result<Kinematics> Zhou2025(const Measurements& data) {
  const Measurements adjusted = AdjustCentres(data);
  SCANCAL_ASSIGN_OR_RETURN(const Kinematics first, VirtualPointHandEye(adjusted));
  return IdentifyByDistances(adjusted, first, Identified::kHandEyeAndLinks);
}

std::vector<double> SpacingErrors(const Measurements& data, const Kinematics& setup) {
  const auto in_base = [&](const Model::View& view) -> Eigen::Vector3d {
    return BaseFromScanner(data, setup, view) * view.balls[0].centre;
  };
  std::vector<double> errors;
  for (const CheckLength& check : data.check)
    errors.push_back((in_base(check.first_pose) - in_base(check.second_pose)).norm() - check.distance);
  return errors;
}

Result<Comparison> Scanner::Compare(const CompareChoice&) const {
  SCANCAL_ASSIGN_OR_RETURN(const Screened screened, Screen(declaration_.data));
  const Measurements& data = screened.data;
  Comparison comparison;
  if (!data.check.empty()) comparison.columns = {{"max/mm"}, {"mean/mm"}};
  for (size_t k = 0; k < data.check.size() && k < kMostPositions; ++k)
    comparison.columns.push_back({std::to_string(k + 1), 2, false, true});
  comparison.columns.push_back({"rms of balls/mm"});
  comparison.columns.push_back({"s", 2, true});
  const std::vector<Method> methods = {{Say(kNominalRobot), [&] { return VirtualPointHandEye(data); }},
                                       {Say(kRen2012), [&] { return Ren2012(data); }},
                                       {Say(kMu2017), [&] { return Mu2017(data); }},
                                       {Say(kZhou2025), [&] { return Zhou2025(data); }},
                                       {Say(kJoint), [&]() -> Result<Kinematics> {
                                          SCANCAL_ASSIGN_OR_RETURN(const JointFit fit,
                                                                   FitJointly(data, model_, screened.hand_eye));
                                          return fit.Found();
                                        }}};
  for (const Method& method : methods) comparison.rows.push_back(RowOf(data, method));
  return comparison;
}

}  // namespace scancal::robot_ball

#include "models/robot_ball/distance_identification.h"
#include <ceres/jet.h>
#include <fmt/format.h>
#include <algorithm>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

namespace scancal {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using View = RobotBall::View;

constexpr int kSeeds = 6;
using Jet = ceres::Jet<double, kSeeds>;

struct SeenPoint {
  Eigen::Vector3d p_in_base;
  Eigen::Matrix3Xd by_free;  // its derivatives
};

struct Pair {
  int a = 0, b = 0;     // points
  double distance = 0;  // 0: the same ball
  int Rows() const { return distance > 0 ? 1 : 3; }
};

// Eq. (1) for all balls of a pose; q: the hand-eye, then the link errors, as RobotBall has them.
template <class T>
void InBase(const std::vector<Link>& links, const View& view, const T* q, T* p) {
  ChainFrame<T> flange = MakeChainFrame<T>(view.base_from_flange);
  MoveAlong(links, view.joints.data(), q + 6, &flange);
  for (const RobotBall::SeenBall& ball : view.balls) {
    const T c[3] = {T(ball.centre[0]), T(ball.centre[1]), T(ball.centre[2])};
    T in_flange[3];
    ceres::AngleAxisRotatePoint(q + 3, c, in_flange);
    for (int i = 0; i < 3; ++i) in_flange[i] += q[i];
    for (int i = 0; i < 3; ++i)
      *p++ = flange.x[i] * in_flange[0] + flange.y[i] * in_flange[1] + flange.z[i] * in_flange[2] + flange.p[i];
  }
}

std::vector<Pair> PairsOfPoses(const RobotData& data, const View& one, int first_of_one, const View& other,
                               int first_of_other) {
  std::vector<Pair> pairs;
  for (int a = 0; a < std::ssize(one.balls); ++a)
    for (int b = 0; b < std::ssize(other.balls); ++b) {
      const auto &of_a = data.spheres[one.balls[a].sphere].centre, &of_b = data.spheres[other.balls[b].sphere].centre;
      pairs.push_back({first_of_one + a, first_of_other + b, (of_a - of_b).norm()});
    }
  return pairs;
}

std::vector<Pair> PairsOf(const RobotData& data) {
  constexpr int kFollowing = 16;
  std::vector<Pair> pairs;
  int first = 0;  // point of the station
  for (const Station& station : data.stations) {
    const int n = static_cast<int>(station.views.size());
    std::vector<int> firsts;
    for (const View& view : station.views) {
      firsts.push_back(first);
      first += static_cast<int>(view.balls.size());
    }
    for (int i = 0; i < n; ++i)
      for (int step = 1; step <= std::min(kFollowing, n / 2); ++step) {
        if (2 * step == n && i >= step) continue;  // opposite in the ring: once
        const int j = (i + step) % n;
        std::ranges::copy(PairsOfPoses(data, station.views[i], firsts[i], station.views[j], firsts[j]),
                          std::back_inserter(pairs));
      }
  }
  return pairs;
}

// The quantities of RobotBall that are free, as positions in (hand-eye, link errors).
std::vector<int> FreeOf(const RobotData& data, Identified identified) {
  std::vector<int> free = {0, 1, 2, 3, 4, 5};
  const RobotBall model(data.links, data.spheres);
  for (int k = RobotBall::kLinks; k < model.FirstOfSpheres() && identified == Identified::kHandEyeAndLinks; ++k)
    if (model.quantities()[k].role == Role::kEstimate) free.push_back(6 + k - RobotBall::kLinks);
  return free;
}

// What MINPACK asks for.
class Distances {
 public:
  using Scalar = double;
  using InputType = VectorXd;
  using ValueType = VectorXd;
  using JacobianType = MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  Distances(const RobotData& data, VectorXd start, Identified identified)
      : data_(data), start_(std::move(start)), free_(FreeOf(data, identified)), pairs_(PairsOf(data)) {
    for (const Pair& pair : pairs_) rows_ += pair.Rows();
  }
  int inputs() const { return static_cast<int>(free_.size()); }
  int values() const { return rows_; }
  VectorXd Start() const { return start_(free_); }
  VectorXd All(const VectorXd& x) const {
    VectorXd q = start_;
    q(free_) = x;
    return q;
  }

  int operator()(const VectorXd& x, VectorXd& r) const {
    const std::vector<SeenPoint> points = Points(x, false);
    Index row = 0;
    for (const Pair& pair : pairs_) {
      const Eigen::Vector3d between = points[pair.a].p_in_base - points[pair.b].p_in_base;
      if (pair.distance > 0) r[row] = between.norm() - pair.distance;
      else r.segment<3>(row) = between;
      row += pair.Rows();
    }
    return 0;
  }

  int df(const VectorXd& x, MatrixXd& J) const {
    const std::vector<SeenPoint> points = Points(x, true);
    Index row = 0;
    for (const Pair& pair : pairs_) {
      const SeenPoint &a = points[pair.a], &b = points[pair.b];
      if (pair.distance > 0)  // eq. (31)
        J.row(row) = (a.p_in_base - b.p_in_base).normalized().transpose() * (a.by_free - b.by_free);
      else J.middleRows<3>(row) = a.by_free - b.by_free;
      row += pair.Rows();
    }
    return 0;
  }

 private:
  std::vector<SeenPoint> Points(const VectorXd& x, bool derivatives) const {
    const VectorXd q = All(x);
    std::vector<SeenPoint> points;
    for (const Station& station : data_.stations)
      for (const View& view : station.views) {
        const size_t first = points.size();
        VectorXd p(3 * std::ssize(view.balls));
        InBase(data_.links, view, q.data(), p.data());
        for (Index b = 0; b < std::ssize(view.balls); ++b) points.push_back({p.segment<3>(3 * b), {}});
        if (derivatives) Derive(view, q, points.data() + first);
      }
    return points;
  }

  void Derive(const View& view, const VectorXd& q, SeenPoint* points) const {
    const Index balls = std::ssize(view.balls), n = std::ssize(free_);
    for (Index b = 0; b < balls; ++b) points[b].by_free.resize(3, n);
    std::vector<Jet> p(3 * balls);
    for (Index from = 0; from < n; from += kSeeds) {
      std::vector<Jet> seeded(q.begin(), q.end());
      const int seeds = static_cast<int>(std::min<Index>(kSeeds, n - from));
      for (int k = 0; k < seeds; ++k) seeded[free_[from + k]].v[k] = 1;
      InBase(data_.links, view, seeded.data(), p.data());
      for (Index b = 0; b < balls; ++b)
        for (int i = 0; i < 3; ++i)
          points[b].by_free.row(i).segment(from, seeds) = p[3 * b + i].v.head(seeds).transpose();
    }
  }

  const RobotData& data_;
  VectorXd start_;
  std::vector<int> free_;
  std::vector<Pair> pairs_;
  int rows_ = 0;
};

VectorXd AsNumbers(const RobotData& data, const RobotSetup& setup) {
  VectorXd q = VectorXd::Zero(6 + kLinkNumbers * std::ssize(data.links));
  q.head<6>() = NumbersOf(setup.flange_from_scanner);
  q.segment(6, kLinkNumbers * std::ssize(setup.link_errors)) = NumbersOf(setup.link_errors);
  return q;
}

RobotSetup AsSetup(const VectorXd& q) { return {PoseOf(q.head<6>()), LinksOf(q.tail(q.size() - 6))}; }

}  // namespace

Result<RobotSetup> IdentifyByDistances(const RobotData& data, const RobotSetup& start, Identified identified) {
  Distances distances(data, AsNumbers(data, start), identified);
  if (distances.values() < distances.inputs())
    return Error{
        fmt::format("balls seen from different poses of a station give {} distances for {} unknowns: see the "
                    "artifact from more poses at each station",
                    distances.values(), distances.inputs())};
  Eigen::LevenbergMarquardt<Distances> solver(distances);
  solver.parameters.xtol = 1e-13;
  solver.parameters.ftol = 1e-15;
  VectorXd x = distances.Start();
  using enum Eigen::LevenbergMarquardtSpace::Status;
  const auto status = solver.minimize(x);
  if (status == TooManyFunctionEvaluation || status == ImproperInputParameters)
    return Error{
        fmt::format("the distances of the balls have no minimum near the first hand-eye (rms {:.3g} mm after "
                    "{} evaluations): look for swapped balls or poses",
                    solver.fnorm / std::sqrt(distances.values()), solver.nfev)};
  return AsSetup(distances.All(x));
}

}  // namespace scancal

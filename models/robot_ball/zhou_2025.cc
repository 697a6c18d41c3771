// The steps of Zhou et al. 2025: adjustment of the centres, identification by distances.
#include <ceres/ceres.h>
#include <fmt/format.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include "models/robot_ball/published.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

using Eigen::Index, Eigen::Matrix3d, Eigen::Matrix3Xd, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

struct Conditions {
  MatrixXd A;         // a row per distance, eq. (11)
  VectorXd closures;  // measured minus CMM, eq. (12)
};

Conditions DistanceConditions(const Matrix3Xd& at, const Matrix3Xd& on_artifact) {
  const Index n = at.cols();
  Conditions conditions{MatrixXd::Zero(n * (n - 1) / 2, 3 * n), VectorXd(n * (n - 1) / 2)};
  Index row = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j, ++row) {
      const Vector3d between = at.col(i) - at.col(j);
      const double length = between.norm();
      conditions.A.block<1, 3>(row, 3 * i) = between.transpose() / length;
      conditions.A.block<1, 3>(row, 3 * j) = -between.transpose() / length;
      conditions.closures[row] = length - (on_artifact.col(i) - on_artifact.col(j)).norm();
    }
  return conditions;
}

// The angle at `apex` between two others, and its derivative by each.
struct Angle {
  double angle = 0;
  Vector3d by_apex, by_one, by_other;

  Angle(const Vector3d& apex, const Vector3d& one, const Vector3d& other) {
    const Vector3d a = one - apex, b = other - apex, normal = a.cross(b);
    angle = std::atan2(normal.norm(), a.dot(b));  // eq. (16), accurate near 0 and pi too
    by_one = a.cross(normal.normalized()) / a.squaredNorm();
    by_other = normal.normalized().cross(b) / b.squaredNorm();
    by_apex = -by_one - by_other;
  }
  // On a line the angle has no derivative.
  bool OnALine() const { return std::sin(angle) < 1e-6; }
};

struct AngleRows {
  MatrixXd B;
  VectorXd d;  // known minus measured
};

AngleRows Angles(const Matrix3Xd& at, const Matrix3Xd& on_artifact) {
  const Index n = at.cols();
  AngleRows rows{MatrixXd::Zero(n * (n - 1) * (n - 2) / 2, 3 * n), VectorXd::Zero(n * (n - 1) * (n - 2) / 2)};
  Index row = 0;
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j)
      for (Index k = j + 1; k < n; ++k) {
        if (j == i || k == i) continue;
        const Angle known(on_artifact.col(i), on_artifact.col(j), on_artifact.col(k));
        const Angle measured(at.col(i), at.col(j), at.col(k));
        if (known.OnALine() || measured.OnALine()) continue;
        rows.B.block<1, 3>(row, 3 * i) = measured.by_apex.transpose();
        rows.B.block<1, 3>(row, 3 * j) = measured.by_one.transpose();
        rows.B.block<1, 3>(row, 3 * k) = measured.by_other.transpose();
        rows.d[row++] = known.angle - measured.angle;
      }
  return {rows.B.topRows(row), rows.d.head(row)};
}

using View = Model::View;

constexpr int kSeeds = 6;
using Jet = ceres::Jet<double, kSeeds>;

struct SeenPoint {
  Eigen::Vector3d p_in_base;
  Eigen::Matrix3Xd by_free;  // its derivatives
};

struct PairOfPoses {
  int a = 0, b = 0;     // points
  double distance = 0;  // 0: the same ball
  int Rows() const { return distance > 0 ? 1 : 3; }
};

// Eq. (1) for all balls of a pose; q: the hand-eye, then the link errors, as Model has them.
template <class T>
void InBase(const std::vector<Link>& links, const View& view, const T* q, T* p) {
  ChainFrame<T> flange = MakeChainFrame<T>(view.base_from_flange);
  MoveAlong(links, view.joints.data(), q + 6, &flange);
  for (const Model::SeenBall& ball : view.balls) {
    const T c[3] = {T(ball.centre[0]), T(ball.centre[1]), T(ball.centre[2])};
    T in_flange[3];
    ceres::AngleAxisRotatePoint(q + 3, c, in_flange);
    for (int i = 0; i < 3; ++i) in_flange[i] += q[i];
    for (int i = 0; i < 3; ++i)
      *p++ = flange.x[i] * in_flange[0] + flange.y[i] * in_flange[1] + flange.z[i] * in_flange[2] + flange.p[i];
  }
}

std::vector<PairOfPoses> PairsOfPoses(const Measurements& data, const View& one, int first_of_one, const View& other,
                                      int first_of_other) {
  std::vector<PairOfPoses> pairs;
  for (int a = 0; a < std::ssize(one.balls); ++a)
    for (int b = 0; b < std::ssize(other.balls); ++b) {
      const auto &of_a = data.spheres[one.balls[a].sphere].centre, &of_b = data.spheres[other.balls[b].sphere].centre;
      pairs.push_back({first_of_one + a, first_of_other + b, (of_a - of_b).norm()});
    }
  return pairs;
}

std::vector<PairOfPoses> PairsOf(const Measurements& data) {
  constexpr int kFollowing = 16;
  std::vector<PairOfPoses> pairs;
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

// The quantities of Model that are free, as positions in (hand-eye, link errors).
std::vector<int> FreeOf(const Measurements& data, Identified identified) {
  std::vector<int> free = {0, 1, 2, 3, 4, 5};
  const Model model(data.links, data.spheres);
  for (int k = Model::kLinks; k < model.FirstOfSpheres() && identified == Identified::kHandEyeAndLinks; ++k)
    if (model.quantities()[k].role == Role::kEstimate) free.push_back(6 + k - Model::kLinks);
  return free;
}

class Distances : public ceres::CostFunction {
 public:
  Distances(const Measurements& data, VectorXd start, Identified identified)
      : data_(data), start_(std::move(start)), free_(FreeOf(data, identified)), pairs_(PairsOf(data)) {
    for (const PairOfPoses& pair : pairs_) rows_ += pair.Rows();
    set_num_residuals(rows_);
    mutable_parameter_block_sizes()->push_back(inputs());
  }
  int inputs() const { return static_cast<int>(free_.size()); }
  int values() const { return rows_; }
  VectorXd Start() const { return start_(free_); }
  VectorXd All(const VectorXd& x) const {
    VectorXd q = start_;
    q(free_) = x;
    return q;
  }

  bool Evaluate(double const* const* at, double* residuals, double** jacobians) const override {
    const VectorXd x = VectorXd::Map(at[0], inputs());
    auto r = VectorXd::Map(residuals, rows_);
    const bool derivatives = jacobians && jacobians[0];
    const std::vector<SeenPoint> points = Points(x, derivatives);
    Index row = 0;
    for (const PairOfPoses& pair : pairs_) {
      const Eigen::Vector3d between = points[pair.a].p_in_base - points[pair.b].p_in_base;
      if (pair.distance > 0) r[row] = between.norm() - pair.distance;
      else r.segment<3>(row) = between;
      row += pair.Rows();
    }
    if (!derivatives) return true;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(jacobians[0], rows_, inputs());
    row = 0;
    for (const PairOfPoses& pair : pairs_) {
      const SeenPoint &a = points[pair.a], &b = points[pair.b];
      if (pair.distance > 0)  // eq. (31)
        J.row(row) = (a.p_in_base - b.p_in_base).normalized().transpose() * (a.by_free - b.by_free);
      else J.middleRows<3>(row) = a.by_free - b.by_free;
      row += pair.Rows();
    }
    return true;
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

  const Measurements& data_;
  VectorXd start_;
  std::vector<int> free_;
  std::vector<PairOfPoses> pairs_;
  int rows_ = 0;
};

VectorXd AsNumbers(const Measurements& data, const Kinematics& setup) {
  VectorXd q = VectorXd::Zero(6 + kLinkNumbers * std::ssize(data.links));
  q.head<6>() = NumbersOf(setup.flange_from_scanner);
  q.segment(6, kLinkNumbers * std::ssize(setup.link_errors)) = NumbersOf(setup.link_errors);
  return q;
}

Kinematics AsKinematics(const VectorXd& q) { return {PoseOf(q.head<6>()), LinksOf(q.tail(q.size() - 6))}; }

}  // namespace

CentreAdjustment AdjustByDistances(const Matrix3Xd& measured, const Matrix3Xd& on_artifact,
                                   const std::vector<Matrix3d>& spreads, int most_iterations) {
  constexpr double kStandsStill = 1e-13;  // of the coordinates
  CentreAdjustment result{measured};
  while (!result.converged && result.iterations++ < most_iterations) {
    const auto [A, closures] = DistanceConditions(result.centres, on_artifact);
    const Matrix3Xd moved = measured - result.centres;
    const VectorXd l = closures + A * moved.reshaped();
    MatrixXd by_unit = A;  // A S: dX = S y, the least |y| with A S y = -l
    for (Index i = 0; i < measured.cols(); ++i) by_unit.middleCols<3>(3 * i) *= spreads[i];
    const VectorXd y = LeastSquares(by_unit, -l);
    Matrix3Xd next = measured;
    for (Index i = 0; i < measured.cols(); ++i) next.col(i) += spreads[i] * y.segment<3>(3 * i);
    result.converged = (next - result.centres).norm() <= kStandsStill * measured.norm();
    result.centres = next;
  }
  return result;
}

Matrix3Xd AdjustByAngles(const Matrix3Xd& measured, const Matrix3Xd& on_artifact) {
  constexpr double kRidge = 1e-3;
  const auto [B, d] = Angles(measured, on_artifact);
  if (B.rows() == 0) return measured;
  const Svd svd = SvdOf(B);
  const VectorXd& sigma = svd.values;
  const double k = std::pow(kRidge * sigma[0], 2);
  const VectorXd filter = sigma.array() / (sigma.array().square() + k);
  const VectorXd dX = svd.v * filter.cwiseProduct(svd.u.transpose() * d);
  return measured + dX.reshaped(3, measured.cols());
}

Measurements AdjustCentres(Measurements data) {
  for (Station& station : data.stations)
    for (Model::View& view : station.views) {
      const Index n = std::ssize(view.balls);
      Matrix3Xd measured(3, n), on_artifact(3, n);
      std::vector<Matrix3d> spreads;
      for (Index i = 0; i < n; ++i) {
        measured.col(i) = view.balls[i].centre;
        on_artifact.col(i) = data.spheres[view.balls[i].sphere].centre;
        spreads.push_back(view.balls[i].spread);
      }
      if (n < 2) continue;
      measured = AdjustByAngles(AdjustByDistances(measured, on_artifact, spreads).centres, on_artifact);
      for (Index i = 0; i < n; ++i) view.balls[i].centre = measured.col(i);
    }
  return data;
}

Result<Kinematics> IdentifyByDistances(const Measurements& data, const Kinematics& start, Identified identified) {
  Distances distances(data, AsNumbers(data, start), identified);
  if (distances.values() < distances.inputs())
    return Error{
        fmt::format("balls seen from different poses of a station give {} distances for {} unknowns: see the "
                    "artifact from more poses at each station",
                    distances.values(), distances.inputs())};
  VectorXd x = distances.Start();
  ceres::Problem::Options keep;
  keep.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(keep);
  problem.AddResidualBlock(&distances, nullptr, x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 400;
  options.function_tolerance = options.gradient_tolerance = 1e-15;
  options.parameter_tolerance = 1e-13;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (summary.termination_type != ceres::CONVERGENCE)
    return Error{
        fmt::format("the distances of the balls have no minimum near the first hand-eye (rms {:.3g} mm after "
                    "{} evaluations): look for swapped balls or poses",
                    std::sqrt(2 * summary.final_cost / distances.values()), summary.iterations.size())};
  return AsKinematics(distances.All(x));
}

}  // namespace scancal::robot_ball

// Laser lines across a sphere of radius 40 mm, from 15 poses of a robot, with the hand-eye that their authors found.
// One line sees a circle: of a known radius its sphere may lie on either side, and which one the authors say
// (SphCtrDirc).
#include <ceres/rotation.h>
#include <gmock/gmock.h>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include "io/units.h"
#include "models/robot_ball.h"
#include "models/sphere.h"
#include "solver/model.h"
#include "solver/refine.h"
#include "tests/real/data_sets.h"

namespace scancal {
namespace {

using Points = std::vector<Eigen::Vector3d>;
constexpr double kRadius = 40;
constexpr int kEvery = 10;

struct Line {
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();
  Points points;  // (x, 0, z) in the profiler's frame
};

class LineProfilerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_))
      GTEST_SKIP() << "NOT TESTED ON REAL DATA: there is no " << folder_
                   << "; set SCANCAL_DATASETS to the folder that holds fanuc-line-profiler/";
    const auto poses = Json("RobPoses.rob")["RobPoses"];
    ASSERT_EQ(poses.size(), 15U);
    for (size_t k = 0; k < poses.size(); ++k)
      lines_.push_back({PoseOfController(poses[k]), ReadLine("p" + std::to_string(k + 1) + ".yml")});
    const auto rows = Json("calibration.sec")["Solution"]["HTM"];
    Eigen::Matrix4d matrix;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) matrix(i, j) = rows[static_cast<size_t>(i)][static_cast<size_t>(j)];
    const Eigen::Quaterniond turn(Eigen::Matrix3d(matrix.topLeftCorner<3, 3>()));  // written in single precision
    authors_.linear() = turn.normalized().toRotationMatrix();
    authors_.translation() = matrix.topRightCorner<3, 1>();
  }

  nlohmann::json Json(const std::string& name) const { return nlohmann::json::parse(std::ifstream(folder_ / name)); }
  // x y z in mm, w p r in degrees: R = Rz(r) Ry(p) Rx(w).
  static Eigen::Isometry3d PoseOfController(const std::vector<double>& numbers) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (Eigen::AngleAxisd(numbers[5] * kDegree, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(numbers[4] * kDegree, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(numbers[3] * kDegree, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() << numbers[0], numbers[1], numbers[2];
    return pose;
  }
  // Every tenth point of scan_line: [ x, 0., z, x, 0., z ... ]
  Points ReadLine(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    std::string numbers = text.str();
    numbers = numbers.substr(numbers.find('[') + 1);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::istringstream stream(numbers);
    Points points;
    int number = 0;
    for (double x, y, z; stream >> x >> y >> z;)
      if (number++ % kEvery == 0) points.emplace_back(x, y, z);
    return points;
  }
  Points InBase(const Eigen::Isometry3d& flange_from_scanner) const {
    Points points;
    for (const Line& line : lines_)
      for (const Eigen::Vector3d& p : line.points) points.push_back(line.base_from_flange * flange_from_scanner * p);
    return points;
  }

  const std::filesystem::path folder_ = DataSets() / "fanuc-line-profiler" / "sphere40_set_2023-10-31";
  std::vector<Line> lines_;
  Eigen::Isometry3d authors_ = Eigen::Isometry3d::Identity();
};

SphereChoice SeenFrom(double y) { return {KnownRadius{kRadius, 0}, Eigen::Vector3d(0, y, 0)}; }

double Rms(const Points& points) {  // from their mean
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) mean += p / static_cast<double>(points.size());
  double squares = 0;
  for (const Eigen::Vector3d& p : points) squares += (p - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(points.size()));
}

TEST_F(LineProfilerTest, ALineFitsASphereOfKnownRadiusOnTheSideThatIsGiven) {
  Points centres, on_the_other_side;
  for (const Line& line : lines_) {
    const RobustSphere sphere = FitRobustSphere(line.points, SeenFrom(1000));  // the centre lies towards -Y
    EXPECT_EQ(sphere.fit.doubt, "");
    EXPECT_GT(sphere.fit.sigma, 0.004);
    EXPECT_LT(sphere.fit.sigma, 0.014);
    EXPECT_LT(sphere.set_aside, 0.04 * static_cast<double>(line.points.size()));
    EXPECT_LT(sphere.fit.centre.y(), -5);
    centres.push_back(line.base_from_flange * authors_ * sphere.fit.centre);
    on_the_other_side.push_back(line.base_from_flange * authors_ *
                                FitRobustSphere(line.points, SeenFrom(-1000)).fit.centre);
  }
  EXPECT_NEAR(Rms(centres), 0.38, 0.01);  // as found with other software
  EXPECT_GT(Rms(on_the_other_side), 10);
}

// Where their hand-eye puts all points, one sphere fits with the radius that it has; better than by single lines.
TEST_F(LineProfilerTest, AllLinesLieOnOneSphere) {
  const Points points = InBase(authors_);
  const SphereFit known = FitSphere(points, {KnownRadius{kRadius, 0}, {}}), free = FitSphere(points);
  EXPECT_EQ(known.doubt + free.doubt, "");
  EXPECT_NEAR(known.sigma, 0.13, 0.01);
  EXPECT_LE(free.sigma, known.sigma);
  EXPECT_NEAR(free.radius, kRadius, 0.1);
}

// |p_in_base - c| - R over all poses: hand-eye as in robot_ball::Model, centre and radius of one sphere.
class SphereOfLines {
 public:
  enum Index { kHandEye = 0, kCentre = 6, kSphereRadius = 9 };
  static constexpr int kRowsPerPoint = 1;
  using View = Line;
  struct Target {
    std::string name;
    std::vector<View> views;
  };
  SphereOfLines(const Eigen::Isometry3d& flange_from_scanner, const Eigen::Vector3d& centre, Role radius) {
    Eigen::Matrix<double, 10, 1> start;
    start << robot_ball::NumbersOf(flange_from_scanner), centre, kRadius;
    for (int k = 0; k < start.size(); ++k)
      quantities_.push_back({"q" + std::to_string(k), k >= 3 && k < 6 ? Unit::kRad : Unit::kMm, Scope::kSystem,
                             k == kSphereRadius ? radius : Role::kEstimate, start[k], 0, false, ""});
  }
  const Quantities& quantities() const { return quantities_; }
  int Points(const View& line) const { return static_cast<int>(line.points.size()); }
  double Count(const View& line) const { return Points(line); }
  template <class T>
  void Residual(const Target&, const View& line, const Seen<T>& q, T* r) const {
    for (const Eigen::Vector3d& p : line.points) {
      const T in_scanner[3] = {T(p[0]), T(p[1]), T(p[2])};
      T in_flange[3], in_base[3];
      ceres::AngleAxisRotatePoint(q.q + kHandEye + 3, in_scanner, in_flange);
      for (int i = 0; i < 3; ++i) in_flange[i] += q[kHandEye + i];
      const Eigen::Isometry3d& pose = line.base_from_flange;
      for (int i = 0; i < 3; ++i)
        in_base[i] = pose(i, 0) * in_flange[0] + pose(i, 1) * in_flange[1] + pose(i, 2) * in_flange[2] + pose(i, 3);
      *r++ = SphereDistance(in_base, q.q + kCentre, q[kSphereRadius]);
    }
  }

 private:
  Quantities quantities_;
};

// As found with other software from all points: 0.092 mm; the radius, if free, 40.03 mm. Their hand-eye leaves 0.13 mm.
TEST_F(LineProfilerTest, AHandEyeFittedToThePointsLeavesLess) {
  const Points points = InBase(authors_);
  const Eigen::Vector3d centre = FitSphere(points, {KnownRadius{kRadius, 0}, {}}).centre;
  for (const Role radius : {Role::kHold, Role::kEstimate}) {
    const Problem problem =
        MakeProblem<SphereOfLines>(std::make_shared<SphereOfLines>(authors_, centre, radius), {{"sphere", lines_}});
    const Fit fit = Refine(problem, NominalStart(problem));
    EXPECT_TRUE(fit.converged) << fit.message;
    EXPECT_NEAR(std::sqrt(fit.cost / static_cast<double>(points.size())), 0.092, 0.004);
    const Eigen::VectorXd& x = fit.estimate.system;
    EXPECT_LT((x.head<3>() - authors_.translation()).norm(), 1.5);
    if (radius == Role::kEstimate) {
      EXPECT_NEAR(x[SphereOfLines::kSphereRadius], 40.03, 0.05);
    }
  }
}

}  // namespace
}  // namespace scancal

#include "models/robot_ball.h"
#include "solver/dense.h"

namespace scancal::robot_ball {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};

}  // namespace

Model::Model(std::vector<Link> links, std::vector<Sphere> spheres, bool measured_in_world)
    : links_(std::move(links)),
      joints_of_terms_(JointsOfTerms(static_cast<int>(links_.size()))),
      spheres_(std::move(spheres)),
      measured_in_world_(measured_in_world) {
  using enum Scope;
  const auto declare = [&](const std::string& name, int count, Scope scope, Role role, const std::string& source = "") {
    for (int k = 0; k < count; ++k)
      quantities_.push_back({name + "_" + kAxes[k], k < 3 ? Unit::kMm : Unit::kRad, scope, role, 0, 0, false,
                             k < 3 || source.empty() ? source : source + "_rotation"});
  };
  declare("hand_eye", 6, kSystem, Role::kEstimate);
  declare("artifact", 6, kTarget, Role::kEstimate);
  declare("repeatability", 6, kView, Role::kEstimate, "repeatability");  // of these two `estimate` means their
  declare("ball", 3, kPoint, Role::kEstimate, "ball");                   // variance
  declare("drift", 3, kSystem, Role::kHold, "drift");
  for (const char* name : {"artifact_scale", "scanner_scale", "expansion"})
    quantities_.push_back({name, Unit::kOne, kSystem, Role::kHold, 0, 0, false, ""});
  DeclareLinks(links_.size(), &quantities_);
  SetDefaultLinkRoles(links_, kLinks, &quantities_);
  DeclareJointTerms(links_.size(), &quantities_);
  for (Quantity& quantity : quantities_) quantity.in_nodes = true;
  quantities_[kScannerScale].in_nodes = false;  // the measured centres are the nodes' constant
  for (const Sphere& sphere : spheres_) length_ = std::max(length_, sphere.centre.norm());
  for (const Sphere& sphere : spheres_) declare("sphere_" + sphere.name, 3, kSystem, Role::kHold, "artifact");
  for (int k = 3; k < 6 && spheres_.size() == 1; ++k)  // a point has no turn
    quantity((measured_in_world_ ? kHandEye : kArtifact) + k).role = Role::kHold;
}

std::vector<StandIns<Model::View>> Model::MakeNodes(const Target& station) const {
  constexpr double kRankTolerance = 1e-9;
  std::vector<StandIns<View>> result;
  for (const View& pose : station.views) {
    // Pivoting takes balls far apart first.
    View node = pose;
    node.balls.clear();
    for (const Eigen::Index k : IndependentColumns(Features(pose.balls), kRankTolerance))
      node.balls.emplace_back().sphere = pose.balls[k].sphere;
    result.push_back({{std::move(node)}, 1});
  }
  return result;
}

Eigen::MatrixXd Model::Interpolate(const std::vector<View>& nodes, const View& pose) const {
  const Eigen::MatrixXd by_feature = LeastSquares(Features(nodes.front().balls), Features(pose.balls));
  const Eigen::Index balls = by_feature.cols(), columns = 3 * by_feature.rows();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * balls, columns + 1);
  for (Eigen::Index b = 0; b < balls; ++b) {
    for (Eigen::Index k = 0; k < by_feature.rows(); ++k)
      result.block<3, 3>(3 * b, 3 * k).diagonal().setConstant(by_feature(k, b));
    result.col(columns).segment<3>(3 * b) = pose.balls[b].centre;
  }
  return result;
}

Eigen::MatrixXd Model::Features(const std::vector<SeenBall>& balls) const {
  Eigen::MatrixXd features(4, std::ssize(balls));
  for (Eigen::Index b = 0; b < features.cols(); ++b) features.col(b) << spheres_[balls[b].sphere].centre, length_;
  return features;
}

void SetTerms(Measurements* data) {
  const auto set = [&](std::vector<Model::View*> views) {
    std::stable_sort(views.begin(), views.end(), [](const auto* a, const auto* b) { return a->number < b->number; });
    SetTermsInOrder(data->links, data->gravity, data->gear_ratios, views);
    const double last = std::max(1.0, static_cast<double>(views.size()) - 1);
    for (size_t v = 0; v < views.size(); ++v) views[v]->time = static_cast<double>(v) / last - 0.5;
  };
  std::vector<Model::View*> poses, check, held_out;
  for (Station& station : data->stations)
    for (Model::View& view : station.views) poses.push_back(&view);
  for (CheckLength& length : data->check) check.insert(check.end(), {&length.first_pose, &length.second_pose});
  for (Station& station : data->held_out)
    for (Model::View& view : station.views) held_out.push_back(&view);
  set(std::move(poses));
  set(std::move(check));
  set(std::move(held_out));
}

Eigen::Isometry3d PoseOf(const Eigen::Matrix<double, 6, 1>& numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d turn = numbers.tail<3>();
  Eigen::Matrix3d rotation;
  ceres::AngleAxisToRotationMatrix(turn.data(), rotation.data());
  pose.linear() = rotation;
  pose.translation() = numbers.head<3>();
  return pose;
}

Eigen::Matrix<double, 6, 1> NumbersOf(const Eigen::Isometry3d& pose) {
  const Eigen::AngleAxisd turn(pose.linear());
  Eigen::Matrix<double, 6, 1> numbers;
  numbers << pose.translation(), turn.angle() * turn.axis();
  return numbers;
}

}  // namespace scancal::robot_ball

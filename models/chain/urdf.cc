#include "models/chain/urdf.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "io/message.h"
#include "io/units.h"

namespace scancal {
namespace {

constexpr double kMm = 1000;
constexpr double kOnAxis_mm = 1e-3;  // angles in a URDF are often written with few digits
constexpr double kTiny_mm = 1e-9, kSame = 1e-9;

Eigen::Matrix3d TurnOf(const std::array<double, 3>& rpy) {
  return (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

// The inverse; near a pitch of 90 deg, where roll and yaw are one, roll is what yaw leaves.
std::array<double, 3> RpyOf(const Eigen::Matrix3d& turn) {
  const double pitch = std::atan2(-turn(2, 0), std::hypot(turn(0, 0), turn(1, 0)));
  const double yaw = std::atan2(turn(1, 0), turn(0, 0));
  const Eigen::Matrix3d roll = TurnOf({0, pitch, yaw}).transpose() * turn;
  return {std::atan2(roll(2, 1), roll(1, 1)), pitch, yaw};
}

Eigen::Isometry3d OriginOf(const UrdfJoint& joint) {
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
  origin.translation() = kMm * Eigen::Vector3d::Map(joint.xyz.data());
  origin.linear() = TurnOf(joint.rpy);
  return origin;
}

struct Axis {
  Eigen::Vector3d point, along;
};

// The least turn of z to this direction; of nearly -z the half turn about x first, whose axis is known.
Eigen::Matrix3d TurnOfZ(const Eigen::Vector3d& direction) {
  constexpr double kNear = 1e-3;
  Eigen::Matrix3d first = Eigen::Matrix3d::Identity();
  Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  if ((direction + z).norm() < kNear) {
    first.diagonal() << 1, -1, -1;
    z = -z;
  }
  const Eigen::Vector3d axis = z.cross(direction);
  const double sine = axis.norm();
  if (sine == 0) return first;
  return Eigen::AngleAxisd(std::atan2(sine, z.dot(direction)), axis / sine).toRotationMatrix() * first;
}

// The axis of the first joint as z, in the base's own frame where that is possible.
Eigen::Isometry3d FrameOfFirst(const Axis& axis) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  if ((axis.along - Eigen::Vector3d::UnitZ()).norm() > kSame) frame.linear() = TurnOfZ(axis.along);
  frame.translation() = axis.point - axis.point.dot(axis.along) * axis.along;  // of its points the nearest
  if (frame.translation().norm() < kTiny_mm) frame.translation().setZero();
  return frame;
}

// alpha and beta that turn z to this direction.
void TurnZ(const Eigen::Vector3d& direction, Link* link) {
  link->beta = std::asin(std::clamp(direction.x(), -1.0, 1.0));
  link->alpha = std::atan2(-direction.y(), direction.z());
}

// Of both directions of x the one nearer to the x before.
double Nearer(double theta) {
  return std::abs(theta) > kTurn_rad / 4 + kSame ? theta - std::copysign(kTurn_rad / 2, theta) : theta;
}

Eigen::Matrix3d Back(double theta) { return Eigen::AngleAxisd(-theta, Eigen::Vector3d::UnitZ()).toRotationMatrix(); }

// From a joint's frame to one whose z is the next axis, which is seen from there.
Link LinkTo(const Axis& next) {
  Link link;
  TurnZ(next.along, &link);
  const bool parallel = NextAxisIsParallel(link);
  const Eigen::Vector2d across = next.along.head<2>();
  // Where the next axis goes through the plane of x and y, or is nearest to this one.
  const double by =
      parallel ? next.point.z() / next.along.z() : next.point.head<2>().dot(across) / across.squaredNorm();
  const Eigen::Vector3d foot = next.point - by * next.along;
  if (!parallel) {
    link.d = foot.z();
    link.theta = Nearer(std::atan2(across.x(), -across.y()));  // x along the common normal
  } else if (foot.head<2>().norm() > kTiny_mm) {
    link.theta = Nearer(std::atan2(foot.y(), foot.x()));
  }
  link.a = (Back(link.theta) * foot).x();
  for (double* length : {&link.d, &link.a})
    if (std::abs(*length) < kTiny_mm) *length = 0;
  TurnZ(Back(link.theta) * next.along, &link);
  return link;
}

// From the last joint's frame to the tip, which is seen from there; as near as five numbers come.
Link LastLink(const Eigen::Isometry3d& tip) {
  Link link;
  const Eigen::Vector3d at = tip.translation();
  const Eigen::Matrix3d turn = tip.linear();
  link.d = at.z();
  if (at.head<2>().norm() > kOnAxis_mm) {
    link.theta = Nearer(std::atan2(at.y(), at.x()));
    link.a = (Back(link.theta) * at).x();
  } else {  // Rz(theta) Rx(alpha) Ry(beta) is any turn
    link.theta = std::hypot(turn(0, 1), turn(1, 1)) > kSame ? std::atan2(-turn(0, 1), turn(1, 1))
                                                            : std::atan2(turn(1, 0), turn(0, 0));
  }
  const Eigen::Matrix3d rest = Back(link.theta) * turn;
  link.alpha = std::atan2(rest(2, 1), rest(1, 1));
  link.beta = std::atan2(rest(0, 2), rest(0, 0));
  return link;
}

std::string Three(const Eigen::Vector3d& numbers) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", numbers[0] + 0.0, numbers[1] + 0.0, numbers[2] + 0.0);  // no -0
}

std::string JointXml(const std::string& name, const char* type, const std::string& parent, const std::string& child,
                     const Eigen::Isometry3d& origin) {
  const std::array<double, 3> rpy = RpyOf(origin.linear());
  return fmt::format(
      "  <link name=\"{3}\"/>\n  <joint name=\"{0}\" type=\"{1}\">\n    <parent link=\"{2}\"/>\n    <child "
      "link=\"{3}\"/>\n    <origin xyz=\"{4}\" rpy=\"{5}\"/>\n{6}  </joint>\n",
      name, type, parent, child, Three(origin.translation() / kMm), Three(Eigen::Vector3d::Map(rpy.data())),
      std::string_view(type) == "fixed" ? "" : "    <axis xyz=\"0 0 1\"/>\n");
}

std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&') escaped += "&amp;";
    else if (c == '<') escaped += "&lt;";
    else if (c == '"') escaped += "&quot;";
    else escaped += c;
  }
  return escaped;
}

}  // namespace

Eigen::Isometry3d BaseFromTip(const std::vector<UrdfJoint>& joints, const std::vector<double>& angles) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  size_t k = 0;
  for (const UrdfJoint& joint : joints) {
    pose = pose * OriginOf(joint);
    if (joint.turns) pose.rotate(Eigen::AngleAxisd(angles[k++], Eigen::Vector3d::Map(joint.axis.data()).normalized()));
  }
  return pose;
}

Result<UrdfLinks> LinksOfUrdf(const std::vector<UrdfJoint>& joints, const std::string& name) {
  UrdfLinks result;
  std::vector<Axis> axes;
  Eigen::Isometry3d tip = Eigen::Isometry3d::Identity();
  for (const UrdfJoint& joint : joints) {
    tip = tip * OriginOf(joint);
    if (!joint.turns) continue;
    axes.push_back({tip.translation(), (tip.linear() * Eigen::Vector3d::Map(joint.axis.data())).normalized()});
    result.joints.push_back(joint.name);
  }
  if (axes.empty()) return Error{name + ": found no joint that turns between base and tip"};
  result.base_from_first = FrameOfFirst(axes[0]);
  Eigen::Isometry3d frame = result.base_from_first;
  for (size_t k = 1; k <= axes.size(); ++k) {
    const Eigen::Isometry3d inverse = frame.inverse();
    result.links.push_back(k < axes.size() ? LinkTo({inverse * axes[k].point, inverse.linear() * axes[k].along})
                                           : LastLink(inverse * tip));
    frame = frame * BaseFromFlange({result.links.back()}, {0});
  }
  if ((frame.translation() - tip.translation()).norm() > 2 * kOnAxis_mm ||
      !frame.linear().isApprox(tip.linear(), kSame))
    return Error{name + ": the frame of " + Quoted(joints.back().child) +
                 " lies off the last axis and is turned as no link is; name one on it: robot: {urdf: ..., tip: tool0}"};
  return result;
}

std::string UrdfOf(const std::string& robot, const UrdfLinks& arm,
                   const std::map<std::string, Eigen::Isometry3d>& on_flange, const std::vector<std::string>& notes) {
  std::string text = "<?xml version=\"1.0\"?>\n";
  for (std::string note : notes) {
    for (size_t at = note.find("--"); at != std::string::npos; at = note.find("--")) note.replace(at, 2, "-");
    text += "<!-- " + note + " -->\n";
  }
  text += "<robot name=\"" + Escaped(robot) + "\">\n  <link name=\"base_link\"/>\n";
  Eigen::Isometry3d origin = arm.base_from_first;
  std::string parent = "base_link";
  for (size_t k = 0; k < arm.links.size(); ++k) {
    const std::string link = "link_" + std::to_string(k + 1);
    text += JointXml(Escaped(k < arm.joints.size() ? arm.joints[k] : "joint_" + std::to_string(k + 1)), "continuous",
                     parent, link, origin);
    origin = BaseFromFlange({arm.links[k]}, {0});
    parent = link;
  }
  text += JointXml("flange_fixed", "fixed", parent, "flange", origin);
  for (const auto& [name, pose] : on_flange)
    text += JointXml(Escaped(name) + "_fixed", "fixed", "flange", Escaped(name), pose);
  return text + "</robot>\n";
}

}  // namespace scancal

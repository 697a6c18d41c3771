#include "models/chain/chain.h"
#include <glog/logging.h>
#include "solver/linearize.h"

namespace scancal {

Eigen::VectorXd NumbersOf(const std::vector<Link>& links) {
  Eigen::VectorXd numbers(kLinkNumbers * std::ssize(links));
  Eigen::Index k = 0;
  for (const Link& link : links)
    for (const double number : {link.theta, link.d, link.a, link.alpha, link.beta}) numbers[k++] = number;
  return numbers;
}

std::vector<Link> LinksOf(const Eigen::VectorXd& numbers) {
  CHECK_EQ(numbers.size() % kLinkNumbers, 0);
  std::vector<Link> links;
  for (Eigen::Index k = 0; k < numbers.size(); k += kLinkNumbers)
    links.push_back({numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3], numbers[k + 4]});
  return links;
}

std::vector<Link> WithErrors(const std::vector<Link>& nominal, const std::vector<Link>& errors) {
  return errors.empty() ? nominal : LinksOf(NumbersOf(nominal) + NumbersOf(errors));
}

Eigen::Isometry3d BaseFromFlange(const std::vector<Link>& links, const std::vector<double>& joints) {
  CHECK_EQ(links.size(), joints.size());
  ChainFrame<double> frame = MakeChainFrame<double>(Eigen::Isometry3d::Identity());
  const std::vector<double> none(kLinkNumbers * links.size());
  MoveAlong(links, joints.data(), none.data(), &frame);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) pose.matrix().row(i) << frame.x[i], frame.y[i], frame.z[i], frame.p[i];
  return pose;
}

void DeclareLinks(size_t links, Quantities* quantities) {
  for (size_t k = 1; k <= links; ++k) {
    const std::string number = std::to_string(k);
    for (const auto& [name, unit] : {std::pair{"theta_", Unit::kRad},
                                     {"d_", Unit::kMm},
                                     {"a_", Unit::kMm},
                                     {"alpha_", Unit::kRad},
                                     {"beta_", Unit::kRad}})
      quantities->push_back({name + number, unit, Scope::kSystem, Role::kHold, 0, 0, false, ""});
  }
}

void DeclareJointTerms(size_t links, Quantities* quantities) {
  const auto declare = [&](const std::string& name, size_t joint, const std::string& more, Unit unit) {
    const std::string number = "_" + std::to_string(joint);
    std::string source = name.substr(0, name.find("_cos"));
    source = source.substr(0, source.find("_sin")) + number;
    quantities->push_back({name + number + more, unit, Scope::kSystem, Role::kHold, 0, 0, true, source});
  };
  for (size_t i = 1; i <= links; ++i)
    for (size_t k = i; k <= links; ++k) declare("gravity", i, "_" + std::to_string(k), Unit::kRad);
  for (size_t i = 1; i <= links; ++i) declare("backlash", i, "", Unit::kRad);
  for (size_t i = 1; i <= links; ++i) declare("joint_scale", i, "", Unit::kOne);
  for (size_t i = 1; i <= links; ++i)
    for (const char* harmonic : {"_cos1", "_sin1", "_cos2", "_sin2"})
      declare(std::string("eccentricity") + harmonic, i, "", Unit::kRad);
  for (size_t i = 1; i <= links; ++i)
    for (const char* name : {"motor_cos", "motor_sin"}) declare(name, i, "", Unit::kRad);
}

std::vector<int> JointsOfTerms(int links) {
  std::vector<int> joints;
  for (int i = 0; i < links; ++i)
    for (int k = i; k < links; ++k) joints.push_back(i);
  for (int kind = 0; kind < 2; ++kind)
    for (int i = 0; i < links; ++i) joints.push_back(i);
  for (const int harmonics : {4, 2})  // of the joint, of its motor
    for (int i = 0; i < links; ++i) joints.insert(joints.end(), static_cast<size_t>(harmonics), i);
  return joints;
}

std::vector<double> JointTermsAt(const std::vector<Link>& links, const std::vector<double>& joints,
                                 const std::vector<int>& direction, const Eigen::Vector3d& gravity,
                                 const std::vector<double>& gear_ratios) {
  CHECK_EQ(links.size(), joints.size());
  constexpr double kRounding = 1e-9;
  const auto n = std::ssize(links);
  std::vector<Eigen::Vector3d> axis, origin, end;
  ChainFrame<double> frame = MakeChainFrame<double>(Eigen::Isometry3d::Identity());
  const double none[kLinkNumbers] = {};
  double reach = 0;
  for (size_t k = 0; k < links.size(); ++k) {
    axis.emplace_back(frame.z);
    origin.emplace_back(frame.p);
    MoveAlong({links[k]}, &joints[k], none, &frame);
    end.emplace_back(frame.p);
    reach += std::abs(links[k].d) + std::abs(links[k].a);
  }
  std::vector<double> at;
  for (std::ptrdiff_t i = 0; i < n; ++i)
    for (std::ptrdiff_t k = i; k < n; ++k) {
      const double moment = axis[i].dot((end[k] - origin[i]).cross(gravity)) / reach;
      at.push_back(std::abs(moment) > kRounding ? moment : 0);  // of a mass on the axis, or an axis along gravity
    }
  for (const int each : direction) at.push_back(each);
  for (const double q : joints) at.push_back(q);
  for (const double q : joints)
    for (const double harmonic : {std::cos(q), std::sin(q), std::cos(2 * q), std::sin(2 * q)}) at.push_back(harmonic);
  for (size_t k = 0; k < joints.size(); ++k) {
    const double ratio = k < gear_ratios.size() ? gear_ratios[k] : 0;
    at.push_back(ratio != 0 ? std::cos(ratio * joints[k]) : 0);
    at.push_back(ratio != 0 ? std::sin(ratio * joints[k]) : 0);
  }
  return at;
}

std::vector<double> TurnedJoints(std::vector<double> joints, const std::vector<double>& at,
                                 const std::vector<double>& terms) {
  if (at.empty() || terms.empty()) return joints;
  CHECK_EQ(at.size(), terms.size());
  const std::vector<int> joint = JointsOfTerms(static_cast<int>(joints.size()));
  for (size_t k = 0; k < at.size(); ++k) joints[joint[k]] += at[k] * terms[k];
  return joints;
}

std::vector<std::string> HoldUndeterminedTerms(int first, int count, Problem* problem, Estimate* at) {
  constexpr double kPart = 0.02;  // less is told by a few poses only
  std::vector<int> candidates;
  for (int k = first; k < first + count; ++k)
    if (problem->quantities[k].role == Role::kEstimate && problem->quantities[k].u == 0) candidates.push_back(k);
  if (candidates.empty()) return {};
  std::vector<std::vector<double>> values;
  for (size_t t = 0; t < problem->targets.size(); ++t) values.push_back(Values(*problem, *at, t));
  const std::vector<std::string> held =
      HoldUndetermined(candidates, kPart, Linearize(*problem, *at, Storey::kViews), problem);
  *at = NominalStart(*problem);
  for (size_t t = 0; t < values.size(); ++t) SetValues(*problem, values[t], t, at);
  return held;
}

std::vector<std::vector<int>> DirectionsOf(const std::vector<const std::vector<double>*>& joints) {
  constexpr double kStill_rad = 1e-6;
  std::vector<std::vector<int>> directions;
  for (size_t v = 0; v < joints.size(); ++v) {
    std::vector<int> now = v ? directions.back() : std::vector<int>(joints[v]->size());
    for (size_t i = 0; v > 0 && i < now.size(); ++i)
      if (const double move = (*joints[v])[i] - (*joints[v - 1])[i]; std::abs(move) > kStill_rad)
        now[i] = move > 0 ? 1 : -1;
    directions.push_back(std::move(now));
  }
  return directions;
}

bool NextAxisIsParallel(const Link& link) {
  constexpr double kParallel_rad = 1e-3;
  return std::abs(std::sin(link.alpha)) < kParallel_rad && std::abs(std::sin(link.beta)) < kParallel_rad;
}

void SetDefaultLinkRoles(const std::vector<Link>& links, int first, Quantities* quantities) {
  for (size_t k = 0; k < links.size(); ++k) {
    const bool is_first = k == 0, is_last = k + 1 == links.size(), parallel = NextAxisIsParallel(links[k]);
    const bool estimated[kLinkNumbers] = {!is_first, !is_first && !parallel, true, true, parallel};
    for (int e = 0; e < kLinkNumbers; ++e)
      (*quantities)[first + kLinkNumbers * static_cast<int>(k) + e].role =
          estimated[e] && !is_last ? Role::kEstimate : Role::kHold;
  }
}

}  // namespace scancal

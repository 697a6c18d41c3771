#include "models/chain/chain.h"
#include <glog/logging.h>

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

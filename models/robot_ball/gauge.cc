#include "models/robot_ball/gauge.h"
#include <glog/logging.h>

namespace scancal {

Gauged InDefaultGauge(const std::vector<Link>& nominal, const RobotSetup& truth) {
  CHECK_EQ(truth.link_errors.size(), nominal.size());
  CHECK(!nominal.empty());
  Gauged gauged{truth, Eigen::Isometry3d::Identity()};
  std::vector<Link>& errors = gauged.setup.link_errors;
  const Link& last = nominal.back();
  // link(q) = Rz(q) link(0)
  gauged.setup.flange_from_scanner = BaseFromFlange({last}, {0}).inverse() *
                                     BaseFromFlange(WithErrors({last}, {errors.back()}), {0}) *
                                     truth.flange_from_scanner;
  errors.back() = {};
  gauged.base_from_true_base = BaseFromFlange({{errors.front().theta, errors.front().d, 0, 0, 0}}, {0}).inverse();
  errors.front().theta = errors.front().d = 0;
  for (size_t k = 0; k + 1 < nominal.size(); ++k) {
    if (!NextAxisIsParallel(nominal[k])) continue;
    errors[k + 1].d += errors[k].d;
    errors[k].d = 0;
  }
  return gauged;
}

}  // namespace scancal

#include "solver/calibration.h"
#include <algorithm>
#include <cmath>

namespace scancal {

std::vector<double> Plain(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

ErrorSize SizeOfErrors(const std::vector<double>& errors) {
  ErrorSize size;
  for (const double error : errors) {
    size.max = std::max(size.max, std::abs(error));
    size.mean += std::abs(error) / static_cast<double>(errors.size());
  }
  return size;
}

}  // namespace scancal

#include "models/parts/calibrated_values.h"

namespace scancal {

Result<Eigen::VectorXd> ValuesOf(const Calibration& calibration, const std::vector<std::string>& names) {
  Eigen::VectorXd values(std::ssize(names));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const Parameter* parameter = calibration.Find(names[k]);
    if (!parameter) return Error{"the calibration has no parameter " + names[k] + ": is it of another robot?"};
    values[k] = parameter->value;
  }
  return values;
}

Result<std::vector<Link>> LinkErrorsOf(const Calibration& calibration, size_t links) {
  Quantities quantities;
  DeclareLinks(links, &quantities);
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) names.push_back(quantity.name);
  SCANCAL_ASSIGN_OR_RETURN(const Eigen::VectorXd numbers, ValuesOf(calibration, names));
  if (calibration.Find("theta_" + std::to_string(links + 1)))
    return Error{"the calibration is of a robot with more joints than the " + std::to_string(links) +
                 " of the data set"};
  return LinksOf(numbers);
}

}  // namespace scancal

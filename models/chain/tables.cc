#include "models/chain/tables.h"
#include <algorithm>

namespace scancal {
namespace {

std::vector<std::string> NamesOfLinks(size_t links) {
  Quantities quantities;
  DeclareLinks(links, &quantities);
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities) names.push_back(quantity.name);
  return names;
}

}  // namespace

NumberTable PoseTable(size_t joints, const std::vector<std::pair<std::string, Unit>>& more) {
  std::vector<std::pair<std::string, Unit>> columns;
  for (size_t k = 1; k <= joints; ++k) columns.push_back({"q" + std::to_string(k), Unit::kRad});
  for (const char* axis : {"x", "y", "z"}) columns.push_back({axis, Unit::kMm});
  columns.insert(columns.end(), more.begin(), more.end());
  return TableOf(columns);
}

void AddPose(const std::vector<double>& joints, const Eigen::Vector3d& flange, const std::vector<double>& more,
             NumberTable* poses) {
  std::vector<double>& row = poses->rows.emplace_back(joints);
  row.insert(row.end(), flange.begin(), flange.end());
  row.insert(row.end(), more.begin(), more.end());
}

NumberTable PointResidualTable() {
  return TableOf({{"pose", Unit::kOne}, {"x", Unit::kMm}, {"y", Unit::kMm}, {"z", Unit::kMm}});
}

void AddNominal(const std::vector<Link>& links, Calibration* calibration) {
  const std::vector<std::string> names = NamesOfLinks(links.size());
  const Eigen::VectorXd numbers = NumbersOf(links);
  for (Parameter& parameter : calibration->parameters) {
    const auto k = std::find(names.begin(), names.end(), parameter.name) - names.begin();
    if (k < numbers.size()) parameter.nominal = numbers[k];
  }
}

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
  SCANCAL_ASSIGN_OR_RETURN(const Eigen::VectorXd numbers, ValuesOf(calibration, NamesOfLinks(links)));
  if (calibration.Find("theta_" + std::to_string(links + 1)))
    return Error{"the calibration is of a robot with more joints than the " + std::to_string(links) +
                 " of the data set"};
  return LinksOf(numbers);
}

std::vector<double> JointTermsOf(const Calibration& calibration, size_t links) {
  Quantities quantities;
  DeclareJointTerms(links, &quantities);
  std::vector<double> terms;
  for (const Quantity& quantity : quantities) {
    const Parameter* parameter = calibration.Find(quantity.name);
    terms.push_back(parameter ? parameter->value : 0);
  }
  return terms;
}

}  // namespace scancal

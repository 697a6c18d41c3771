#include "models/chain/tables.h"
#include <fmt/format.h>
#include <algorithm>
#include "models/chain/declare.h"

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

std::vector<Link> NominalLinksOf(const Calibration& calibration) {
  std::vector<double> numbers;
  Quantities names;
  size_t links = 0;
  while (calibration.Find("theta_" + std::to_string(links + 1))) ++links;
  DeclareLinks(links, &names);
  for (const Quantity& quantity : names) {
    const Parameter* parameter = calibration.Find(quantity.name);
    if (!parameter || !parameter->nominal) return {};
    numbers.push_back(*parameter->nominal);
  }
  return LinksOf(Eigen::VectorXd::Map(numbers.data(), std::ssize(numbers)));
}

Result<Propagation> PropagateTool(const Calibration& calibration, const PointRequest& points, bool distances,
                                  const PointOfTool& point) {
  const std::vector<Link> links = NominalLinksOf(calibration);
  if (links.empty())
    return Error{
        "propagate: the calibration knows no nominal links: its poses were those of the flange, or it holds no "
        "data; expected one of joint angles, with its data"};
  std::vector<ScanColumn> columns;
  Propagation result;
  for (size_t k = 1; k <= links.size(); ++k) {
    result.reading.push_back("q" + std::to_string(k));
    result.units.push_back(Unit::kRad);
    columns.push_back({result.reading.back(), Dimension::kAngle});
  }
  for (const char* axis : {"x", "y", "z"}) {
    result.reading.emplace_back(axis);
    result.units.push_back(Unit::kMm);
    columns.push_back({axis, Dimension::kLength});
  }
  SCANCAL_ASSIGN_OR_RETURN(const auto readings, ReadPoints(points, columns));
  const std::vector<Coupling> couplings = ReadCouplings(points.declared, links.size());
  const JointCovariance joint = JointOf(calibration);
  const auto at = [&](const std::vector<double>& reading, const std::string& moved, double by) {
    const auto value = [&](const std::string& name) {
      const Parameter* parameter = calibration.Find(name);
      return (parameter ? parameter->value : 0) + (name == moved ? by : 0);
    };
    const auto n = static_cast<std::ptrdiff_t>(links.size());
    return point(value, Uncoupled({reading.begin(), reading.begin() + n}, couplings),
                 Eigen::Vector3d::Map(&reading[links.size()]));
  };
  std::vector<Eigen::MatrixXd> derivatives;
  for (const std::vector<double>& reading : readings) {
    Eigen::MatrixXd& by = derivatives.emplace_back(3, std::ssize(joint.names));
    for (size_t k = 0; k < joint.names.size(); ++k) {
      const double step = 0.1 * calibration.Find(joint.names[k])->u;
      by.col(static_cast<Eigen::Index>(k)) =
          (at(reading, joint.names[k], step) - at(reading, joint.names[k], -step)) / (2 * step);
    }
    result.points.push_back({reading, at(reading, "", 0), UncertaintyOf(joint, by)});
  }
  for (size_t i = 1; distances && i < result.points.size(); ++i) {
    const Eigen::MatrixXd by = derivatives[i] - derivatives[i - 1];
    const Eigen::Vector3d apart = result.points[i].position - result.points[i - 1].position;
    if (!(apart.norm() > 0)) continue;
    result.distances.push_back({i - 1, i, apart.norm(), UncertaintyOf(joint, apart.normalized().transpose() * by)});
  }
  std::string noise;
  for (const Influence& influence : calibration.influences)
    if (influence.u > 0 && (influence.scope == Scope::kView || influence.scope == Scope::kPoint))
      noise +=
          fmt::format("{}{} {:.2g} {}", noise.empty() ? "" : ", ", influence.source, influence.u, Name(influence.unit));
  result.notes.push_back("not in it: what one pose and one reading err by" +
                         (noise.empty() ? std::string() : " (" + noise + ")"));
  return result;
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

#include "models/turntable/use.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include "io/progress.h"
#include "io/units.h"
#include "solver/dense.h"

namespace scancal::turntable {
namespace {

const Quantities& AllQuantities() {
  static const Model model(Model::Residuals::kDepth);
  return model.quantities();
}

constexpr int kNodesOfVolume = 5;  // of the grid, along each of alpha, y, z

const std::vector<std::string>& Columns() {
  static const std::vector<std::string> columns = {"alpha", "y", "z", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"};
  return columns;
}

std::vector<std::vector<double>> GridOver(const ScannedVolume& volume) {
  const auto node = [](const std::array<double, 2>& range, int k) {
    return range[0] + (range[1] - range[0]) * k / (kNodesOfVolume - 1);
  };
  std::vector<std::vector<double>> nodes;
  for (int i = 0; i < kNodesOfVolume; ++i)
    for (int j = 0; j < kNodesOfVolume; ++j)
      for (int k = 0; k < kNodesOfVolume; ++k)
        nodes.push_back({node(volume.alpha, i), node(volume.y, j), node(volume.z, k)});
  return nodes;
}

// What a point has besides, if it is one reading and no mean. The budget names it where the fit is weighted.
std::string OneReading(const Calibration& calibration, const std::vector<PropagatedPoint>& points) {
  const double noise =
      std::hypot(UOfSource(calibration, "noise_y"), UOfSource(calibration, "line_correlation (offset)"));
  if (!(noise > 0)) return "not in it: the noise of the reading itself";
  double radius = 0;
  for (const PropagatedPoint& point : points) radius = std::max(radius, point.position.head<2>().norm());
  std::string text = fmt::format(
      "not in it: u of one reading, {:.2g} mm along depth, of a lidar along the range (noise_y, line_correlation)",
      noise);
  if (const double jitter = UOfSource(calibration, "encoder_jitter"); jitter > 0)
    text += fmt::format(", and up to {:.2g} mm about the axis for these points (encoder_jitter)", radius * jitter);
  return text + "; a mean over many profiles is free of it";
}

bool AnyMoves(int axis, const std::vector<PropagatedPoint>& points) {
  return std::any_of(points.begin(), points.end(),
                     [&](const PropagatedPoint& point) { return point.uncertainty.covariance(axis, axis) > 0; });
}

std::vector<std::string> OutsideOf(const ScannedVolume& volume, const std::vector<PropagatedPoint>& points) {
  size_t count = 0;
  std::string first;
  for (size_t i = 0; i < points.size(); ++i) {
    const std::vector<double>& reading = points[i].reading;
    const std::string beyond = volume.Beyond(reading[0], reading[1], reading[2]);
    if (beyond.empty()) continue;
    if (++count == 1) first = fmt::format("point {}: {}", i + 1, beyond);
  }
  if (count == 0) return {};
  return {
      fmt::format("{} of {} points outside what the calibration has seen; first {}: their u supposes that the model "
                  "holds there, too",
                  count, points.size(), first)};
}

constexpr double kSlack = 0.01;  // of a range: rounded angles and uneven lines are not outside

bool Within(double value, const std::array<double, 2>& range) {
  const double slack = kSlack * (range[1] - range[0]);
  return value >= range[0] - slack && value <= range[1] + slack;
}

}  // namespace

void ScannedVolume::Extend(double at_alpha, double at_y, double at_z) {
  for (const auto& [range, value] : {std::pair{&alpha, at_alpha}, {&y, at_y}, {&z, at_z}})
    *range = {std::min((*range)[0], value), std::max((*range)[1], value)};
}

std::string ScannedVolume::Beyond(double at_alpha, double at_y, double at_z) const {
  const auto told = [](const char* name, double value, const std::array<double, 2>& range, const char* unit) {
    return fmt::format("{} = {:.4g} {} (scanned: {:.4g} to {:.4g} {})", name, value, unit, range[0], range[1], unit);
  };
  if (!Within(at_alpha, alpha))
    return told("alpha", at_alpha / kDegree, {alpha[0] / kDegree, alpha[1] / kDegree}, "deg");
  if (!Within(at_y, y)) return told("y", at_y, y, "mm");
  if (!Within(at_z, z)) return told("z", at_z, z, "mm");
  return "";
}

double WholeTurnsAway(const ScannedVolume& volume, double alpha) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const double middle = (volume.alpha[0] + volume.alpha[1]) / 2;
  return Within(alpha, volume.alpha) ? alpha : alpha - kTurn * std::round((alpha - middle) / kTurn);
}

ScannedVolume VolumeOf(const std::vector<Placement>& placements) {
  ScannedVolume volume;
  for (const Placement& placement : placements)
    for (const Profile& profile : placement.profiles)
      for (const PseudoPoint& end : Ends(profile.factor)) volume.Extend(profile.alpha, end.y, end.z);
  return volume;
}

double UOfSource(const Calibration& calibration, const std::string& source) {
  for (const BudgetLine& line : calibration.budget)
    if (line.source.english == source) return line.u;
  return 0;
}

Result<System> SystemOf(const Calibration& calibration) {
  System system;
  for (size_t k = 0; k < system.q.size(); ++k) {
    const std::string& name = AllQuantities()[k].name;
    if (const Parameter* parameter = calibration.Find(name)) {
      system[k] = parameter->value;
    } else if (k == Model::kM || k == Model::kN) {
      return Error{"the calibration has no parameter " + name + ", expected the result of a turntable"};
    }
  }
  const std::optional<ScannedVolume> volume = VolumeOf(calibration);
  if (system.Bends() && !volume)
    return Error{"the calibration has a linearity, but no volume to tell the range of depths; refine the data again"};
  if (volume) {
    system.depths = volume->y;
    system.heights = volume->z;
  }
  return system;
}

Result<PointUncertainty> PointUncertainty::From(const Calibration& calibration) {
  SCANCAL_ASSIGN_OR_RETURN(const System system, SystemOf(calibration));
  const std::optional<ScannedVolume> volume = VolumeOf(calibration);
  if (!volume) return Error{"the calibration has no volume, so an older version wrote it; refine the data again"};
  PointUncertainty result(system, *volume, JointOf(calibration));
  result.joint_.Renew(AllQuantities()[Model::kExpansion].name);
  const std::vector<std::string>& names = result.joint_.names;
  for (const std::string& name : names) result.index_.push_back(Find(AllQuantities(), name));
  for (int k = 0; k < static_cast<int>(System::kQuantities); ++k) {
    const Parameter* parameter = calibration.Find(AllQuantities()[k].name);
    if (parameter && parameter->u > 0 && std::find(names.begin(), names.end(), parameter->name) == names.end())
      return Error{"the calibration has a u of " + parameter->name +
                   ", but neither a covariance nor a sensitivity of it; refine the data again"};
  }
  return result;
}

Eigen::MatrixXd PointUncertainty::ByJoint(const Eigen::Ref<const Eigen::MatrixXd>& by_system) const {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(by_system.rows(), std::ssize(index_));
  for (Eigen::Index k = 0; k < std::ssize(index_); ++k)
    if (index_[k] >= 0 && index_[k] < by_system.cols()) by.col(k) = by_system.col(index_[k]);  // a form moves none
  return by;
}

MeasurandUncertainty PointUncertainty::Of(const Eigen::Ref<const Eigen::MatrixXd>& by_system,
                                          Eigen::VectorXd* scale) const {
  const Eigen::MatrixXd by = ByJoint(by_system);
  if (!scale) return UncertaintyOf(joint_, by);
  const auto q = std::find(index_.begin() + joint_.own.rows(), index_.end(), Model::kScaleY) - index_.begin();
  *scale = by_system.col(Model::kScaleY);
  if (q == std::ssize(index_)) {
    *scale += system_.M() * by_system.col(Model::kM) + system_.N() * by_system.col(Model::kN);
    return UncertaintyOf(joint_, by);
  }
  const double variance = joint_.matrix(q, q);
  *scale = by * joint_.matrix.col(q) / variance;
  MeasurandUncertainty of = UncertaintyOf(joint_, by);
  of.covariance -= *scale * scale->transpose() * variance;
  return of;
}

PropagatedPoint PointUncertainty::At(double alpha, double y, double z) const {
  const System::Derivatives of = system_.Differentiate(alpha, y, z);
  return {{alpha, y, z}, of.point, UncertaintyOf(joint_, ByJoint(of.by))};
}

Eigen::Matrix3d PointUncertainty::CovarianceAt(double alpha, double y, double z) const {
  const Eigen::MatrixXd by = ByJoint(system_.Differentiate(alpha, y, z).by);
  return by * joint_.matrix * by.transpose();
}

PropagatedDistance PointUncertainty::Between(const PropagatedPoint& a, const PropagatedPoint& b) const {
  const auto of = [&](const PropagatedPoint& p) {
    return system_.Differentiate(p.reading[0], p.reading[1], p.reading[2]);
  };
  const Eigen::MatrixXd by = ByJoint(of(b).by - of(a).by);
  Eigen::Vector3d along = b.position - a.position;
  const double value = along.norm();
  if (value > 0) {
    along /= value;
  } else {
    along = EigenOf(by * joint_.matrix * by.transpose()).vectors.col(2);
  }
  return {0, 0, value, UncertaintyOf(joint_, along.transpose() * by)};
}

std::optional<ScannedVolume> VolumeOf(const Calibration& calibration) {
  if (calibration.volume.columns != Columns() || calibration.volume.rows.empty()) return {};
  ScannedVolume volume;
  for (const std::vector<double>& row : calibration.volume.rows) volume.Extend(row[0], row[1], row[2]);
  return volume;
}

void AddVolume(const std::vector<Placement>& placements, Calibration* calibration) {
  NumberTable& map = calibration->volume;
  map.columns = Columns();
  map.units.assign(map.columns.size(), Unit::kMm);
  map.units[0] = Unit::kRad;
  map.rows = GridOver(VolumeOf(placements));
  const Result<PointUncertainty> points = PointUncertainty::From(*calibration);
  CHECK(points.ok()) << points.error().message;
  for (std::vector<double>& row : map.rows) {
    const PropagatedPoint point = points->At(row[0], row[1], row[2]);
    row.insert(row.end(), point.position.begin(), point.position.end());
    row.insert(row.end(), point.uncertainty.U.begin(), point.uncertainty.U.end());
    row.push_back(point.uncertainty.U_max);
  }
}

namespace {

// As alpha, y, z: typed ones, and a file with the columns of a scan, say the angle that the encoder shows; the column
// alpha of a table that was written here is that angle with its sense. One turn more or less is the same place.
Result<std::vector<std::vector<double>>> Readings(const PointRequest& points, const ScannedVolume& volume) {
  const ScanColumn angle{"angle", Dimension::kAngle}, alpha{"alpha", Dimension::kAngle}, y{"y", Dimension::kLength},
      z{"z", Dimension::kLength}, bearing{"bearing", Dimension::kAngle}, range{"range", Dimension::kLength};
  std::vector<std::vector<double>> readings;
  const auto add = [&](std::vector<std::vector<double>> read, bool is_reading, bool is_lidar) {
    for (std::vector<double>& p : read) {
      if (is_lidar) p = {p[0], p[2] * std::cos(p[1]), p[2] * std::sin(p[1])};
      if (is_reading) p = {points.angle_sense * p[0], points.depth_sense * p[1], p[2]};
      p[0] = WholeTurnsAway(volume, p[0]);
      readings.push_back(p);
    }
  };
  PointRequest typed = points;
  typed.file.clear();
  const bool any_typed = points.typed.find_first_not_of("; ") != std::string::npos;
  if (any_typed || points.file.empty()) {
    SCANCAL_ASSIGN_OR_RETURN(auto read, ReadPoints(typed, {angle, y, z}));
    add(std::move(read), true, false);
  }
  if (points.file.empty()) return readings;
  PointRequest file = points;
  file.typed.clear();
  auto read = ReadPoints(file, {angle, y, z});
  bool is_reading = true, is_lidar = false;
  if (!read.ok() && read.error().kind == ErrorKind::kMissingColumns) {
    if (auto lidar = ReadPoints(file, {angle, bearing, range}); lidar.ok()) {
      read = std::move(lidar);
      is_lidar = true;
    } else if (auto written = ReadPoints(file, {alpha, y, z});
               written.ok() || written.error().kind != ErrorKind::kMissingColumns) {
      read = std::move(written);
      is_reading = false;
    }
  }
  if (!read.ok()) return read.error();
  add(*std::move(read), is_reading, is_lidar);
  return readings;
}

void AppendExtras(const Eigen::Matrix3d& covariance, const PointExtras& wants, std::vector<double>* numbers) {
  for (int i = 0; wants.u && i < 3; ++i) numbers->push_back(std::sqrt(std::max(0.0, covariance(i, i))));
  for (int i = 0; wants.covariance && i < 3; ++i)
    for (int j = i; j < 3; ++j) numbers->push_back(covariance(i, j));
}

}  // namespace

Result<Propagation> Propagate(const Calibration& calibration, const PointRequest& points, bool distances) {
  SCANCAL_ASSIGN_OR_RETURN(const PointUncertainty uncertainty, PointUncertainty::From(calibration));
  SCANCAL_ASSIGN_OR_RETURN(const auto readings, Readings(points, uncertainty.volume()));
  Propagation result;
  result.reading = {"alpha", "y", "z"};
  result.units = {Unit::kRad, Unit::kMm, Unit::kMm};
  for (const std::vector<double>& reading : readings)
    result.points.push_back(uncertainty.At(reading[0], reading[1], reading[2]));
  for (size_t i = 1; distances && i < result.points.size(); ++i) {
    result.distances.push_back(uncertainty.Between(result.points[i - 1], result.points[i]));
    result.distances.back().from = i - 1;
    result.distances.back().to = i;
  }
  result.notes = {OneReading(calibration, result.points)};
  if (!AnyMoves(2, result.points))
    result.notes.push_back("no u of Z: neither tilts nor scale_z were estimated or considered");
  result.warnings = OutsideOf(uncertainty.volume(), result.points);
  return result;
}

Result<int64_t> Transform(const Dataset& dataset, const Calibration& calibration, PointCloudWriter* cloud) {
  SCANCAL_ASSIGN_OR_RETURN(const System system, SystemOf(calibration));
  Model model(Model::Residuals::kDepth);
  SCANCAL_ASSIGN_OR_RETURN(const Declaration declaration, Declare(dataset, &model, /*searches=*/false));
  std::set<std::pair<std::filesystem::path, decltype(TextFormat::where)>>
      done;  // several targets may be regions of one scan, which is written whole, once
  std::optional<PointUncertainty> uncertainty;
  if (cloud->wants().size() > 0) {
    SCANCAL_ASSIGN_OR_RETURN(uncertainty, PointUncertainty::From(calibration));
  }
  int64_t points = 0;
  int number = 0;
  for (ScanDeclaration scan : declaration.scans) {
    if (!done.insert({scan.format.path.lexically_normal(), scan.format.text.where}).second) continue;
    scan.format.lines.reset();
    SCANCAL_ASSIGN_OR_RETURN(const auto reader, ScanReader::Open(scan.format));
    Progress progress("transforming " + scan.scan);
    ScanBatch batch;
    SensorColumns sensor;
    std::vector<std::array<double, 3>> transformed;
    std::vector<double> beside;
    for (;;) {
      SCANCAL_ASSIGN_OR_RETURN(const bool more, reader->Next(&batch));
      if (!more) break;
      ToSensor(declaration.senses, batch, &sensor);
      transformed.clear();
      beside.clear();
      for (size_t i = 0; i < batch.size(); ++i) {
        if (uncertainty)
          AppendExtras(uncertainty->CovarianceAt(sensor.alpha[i], sensor.y[i], sensor.z[i]), cloud->wants(), &beside);
        const Eigen::Vector3d p = system.Point(sensor.alpha[i], sensor.y[i], sensor.z[i]);
        transformed.push_back({p.x(), p.y(), p.z()});
      }
      SCANCAL_RETURN_IF_ERROR(cloud->Write(transformed, number, beside));
      points += static_cast<int64_t>(transformed.size());
      progress.Show(static_cast<double>(reader->bytes_read()) /
                    static_cast<double>(std::max<int64_t>(1, reader->bytes_total())));
    }
    ++number;
  }
  return points;
}

}  // namespace scancal::turntable

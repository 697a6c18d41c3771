#include "models/turntable/volume.h"
#include <fmt/format.h>
#include <glog/logging.h>
#include <algorithm>
#include <limits>
#include "io/units.h"
#include "models/turntable/calibrated_turntable.h"

namespace scancal {
namespace {

constexpr int kNodes = 5;        // of the grid, along each of alpha, y, z
constexpr double kSlack = 0.01;  // of a range: rounded angles and uneven lines are not outside

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr ScannedVolume kNowhere = {{kInfinity, -kInfinity}, {kInfinity, -kInfinity}, {kInfinity, -kInfinity}};

void Extend(double value, std::array<double, 2>* range) {
  (*range)[0] = std::min((*range)[0], value);
  (*range)[1] = std::max((*range)[1], value);
}

const std::vector<std::string>& Columns() {
  static const std::vector<std::string> columns = {"alpha", "y", "z", "X", "Y", "Z", "U_x", "U_y", "U_z", "U_max"};
  return columns;
}

std::vector<std::vector<double>> GridOver(const ScannedVolume& volume) {
  const auto node = [](const std::array<double, 2>& range, int k) {
    return range[0] + (range[1] - range[0]) * k / (kNodes - 1);
  };
  std::vector<std::vector<double>> nodes;
  for (int i = 0; i < kNodes; ++i)
    for (int j = 0; j < kNodes; ++j)
      for (int k = 0; k < kNodes; ++k) nodes.push_back({node(volume.alpha, i), node(volume.y, j), node(volume.z, k)});
  return nodes;
}

bool Within(double value, const std::array<double, 2>& range) {
  const double slack = kSlack * (range[1] - range[0]);
  return value >= range[0] - slack && value <= range[1] + slack;
}

}  // namespace

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

ScannedVolume VolumeOf(const std::vector<Placement>& placements) {
  ScannedVolume volume = kNowhere;
  for (const Placement& placement : placements) {
    for (const Profile& profile : placement.profiles) {
      Extend(profile.alpha, &volume.alpha);
      for (const PseudoPoint& end : Ends(profile.factor)) {
        Extend(end.z, &volume.z);
        Extend(end.y, &volume.y);
      }
    }
  }
  return volume;
}

std::optional<ScannedVolume> VolumeOf(const Calibration& calibration) {
  if (calibration.volume.columns != Columns() || calibration.volume.rows.empty()) return {};
  ScannedVolume volume = kNowhere;
  for (const std::vector<double>& row : calibration.volume.rows) {
    Extend(row[0], &volume.alpha);
    Extend(row[1], &volume.y);
    Extend(row[2], &volume.z);
  }
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

}  // namespace scancal

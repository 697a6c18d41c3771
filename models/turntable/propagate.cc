// What single readings of the turntable are worth.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "models/turntable/calibrated_turntable.h"
#include "models/turntable/turntable_scanner.h"

namespace scancal {
namespace {

double UOfSource(const Calibration& calibration, const std::string& source) {
  for (const BudgetLine& line : calibration.budget)
    if (line.source == source) return line.u;
  return 0;
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

}  // namespace

Result<Propagation> PropagateTurntable(const Calibration& calibration, const PointRequest& points, bool distances) {
  SCANCAL_ASSIGN_OR_RETURN(const PointUncertainty uncertainty, PointUncertainty::From(calibration));
  SCANCAL_ASSIGN_OR_RETURN(
      const auto readings,
      ReadPoints(points, {{"alpha", Dimension::kAngle}, {"y", Dimension::kLength}, {"z", Dimension::kLength}}));
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
  result.warnings = OutsideOf(uncertainty.turntable().volume(), result.points);
  return result;
}

}  // namespace scancal

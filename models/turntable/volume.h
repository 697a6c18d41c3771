// The readings over which the scans of a data set extend.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>
#include "models/turntable/placement.h"
#include "solver/calibration.h"

namespace scancal {

struct ScannedVolume {
  std::array<double, 2> alpha{}, y{}, z{};  // from, to; rad, mm
  // "y = 300 mm (scanned: 40 to 120 mm)" of the first coordinate that lies outside by more than a hundredth of the
  // range; else empty.
  std::string Beyond(double alpha, double y, double z) const;
};

// Of the readings in a calibration's volume; old files have none.
std::optional<ScannedVolume> VolumeOf(const Calibration& calibration);

// A profile is taken to end where an evenly spaced line of the same mean and spread does: its points are gone.
ScannedVolume VolumeOf(const std::vector<Placement>& placements);

// Calibration::volume: the points of a grid of readings over all scans with their expanded uncertainties, see
// PointUncertainty. Everything else that they come from must be in place.
void AddVolume(const std::vector<Placement>& placements, Calibration* calibration);

}  // namespace scancal

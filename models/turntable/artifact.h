// An artifact as a turntable sees it, with known truth: balls and planes.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>
#include "models/turntable/simulate.h"
#include "models/turntable/verify.h"

namespace scancal::turntable {

struct Instrument {  // its system, and the noise of a point along depth (mm), of an angle (rad), as of a Scene
  System system{{123, 409}, {}};
  double noise_y = 0.03, encoder_jitter = 3e-5, line_correlation = 1;
};

// Readings of the ball about a centre (table frame), where it is seen; none at grazing incidence. Angles are those that
// the encoder shows.
SeenTarget SeeBall(const Instrument& instrument, const std::string& name, const Eigen::Vector3d& centre, double radius,
                   uint64_t seed);
// Of the plane n . P = d, for alpha (rad) and z in these intervals.
SeenTarget SeePlane(const Instrument& instrument, const std::string& name, const Eigen::Vector3d& normal,
                    double distance, const std::array<double, 2>& alphas, const std::array<double, 2>& heights,
                    uint64_t seed);

struct Artifact {
  std::vector<SeenTarget> targets;
  std::vector<Feature> features;
};
// A ball bar across the scan, with the diameter of one ball, and a step of 20 mm, 100 mm in front of the profiler.
// seed: of the noise and of the errors of the reference, u_reference (mm).
Artifact SeeArtifact(const Instrument& instrument, double u_reference, uint64_t seed);

// folder/verify.yaml and a CSV for each target: the artifact as the instrument of this scene sees it.
Result<void> WriteArtifact(const Scene& scene, const std::filesystem::path& folder);

}  // namespace scancal::turntable

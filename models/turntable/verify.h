// A calibrated turntable against an artifact that took no part.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>
#include "io/dataset.h"
#include "io/result.h"
#include "models/turntable/compress.h"
#include "models/turntable/use.h"
#include "solver/results.h"

namespace scancal::turntable {

struct Feature {
  enum class Kind {
    kDiameter,  // of a sphere
    kDistance,  // of the centres of two spheres
    kStep       // of two parallel planes: offset of the second along the common normal
  };
  std::string name, at;
  Kind kind = Kind::kDiameter;
  std::vector<size_t> of;                          // targets
  double nominal = 0, u = 0;                       // mm; of the reference, one error for all features of this name
  std::optional<std::array<double, 2>> tolerance;  // of the deviation, mm
};

const char* Name(Feature::Kind kind);  // as its key: "diameter"

struct SeenTarget {
  std::string name, scan;  // scan: profiles at one angle of one scan share their errors
  SensorColumns points;
};

// The points of a target that `keep` keeps, as they were read.
Result<SensorColumns> ReadKept(const ScanDeclaration& scan, const Senses& senses);

// Each shape is fitted robustly to the points P_i as the calibration sees them, orthogonally, and a feature f moves
// with them by g_i = df/dP_i, in closed form. Its variance has three parts: of the calibration, sum g_i' dP_i/dq for
// every quantity q of the system with their joint covariance (PointUncertainty::Of); of noise as the calibration found
// it, of a point along depth and along the line, of a profile by its angle and its depth; of the reference. Where the
// residuals from the shape are larger than that noise explains (F test, p < 0.001), its part grows with them. Error: a
// shape that its points do not determine.
Result<Verification> VerifyFeatures(const Calibration& calibration, const std::vector<SeenTarget>& targets,
                                    const std::vector<Feature>& features);

// The model's part of ScannerKind; docs/data.md, section 9.
Result<Verification> Verify(const Dataset& dataset, const Calibration& calibration);

}  // namespace scancal::turntable

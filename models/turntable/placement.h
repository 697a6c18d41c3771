// One placement of the plate: its profiles, compressed. The points are gone behind this line.
#pragma once
#include <map>
#include <string>
#include <vector>
#include "io/result.h"
#include "models/parts/line_correlation.h"
#include "models/parts/residual_histogram.h"
#include "models/turntable/declaration.h"
#include "models/turntable/profile.h"
#include "models/turntable/raw_profiles.h"
#include "solver/calibration.h"

namespace scancal {

struct Placement {
  std::string name;
  std::vector<Profile> profiles;
  double missing = 0;                       // no return
  std::map<std::string, double> set_aside;  // reason -> points
  double largest = 0;                       // |coordinate|, mm, over all kept points
  LagSums lag_sums;                         // of the residuals from each profile's own line, with three points or more
  ResidualHistogram histogram;              // of the same, by their pooled standard deviation
  std::string warning;                      // of reading; empty: none
  double Points() const;
  double Sweep() const;    // largest minus smallest angle, rad
  PureError Pure() const;  // of all profiles
  bool IsLidar() const { return !profiles.empty() && profiles.front().ranged.has_value(); }
};

PureError PureOf(const std::vector<Placement>& placements);  // of all of them

// Orders the points of each profile along z and removes what is off its own line.
void Clean(RawScan* scan);

// Reads, keeps, groups into profiles, and cleans. Shows progress.
Result<RawScan> ReadCleanScan(const ScanDeclaration& scan, double sense);

// Sets aside what is off the plane of most profiles, as `system` sees it, and compresses the rest.
Placement CompressPlacement(const RawScan& scan, const turntable::System& system);

// The residuals from each profile's own line, for the result.
ViewResiduals ResidualsOf(const Placement& placement);

// Units and angles that cannot be: "angles span 30 rad ...; are they degrees?"
Result<void> CheckPlausible(const std::vector<Placement>& placements, const Units& units);

}  // namespace scancal

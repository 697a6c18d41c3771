// An artifact measured with repeated calibrations: how often U of each kind of feature holds its error.
#pragma once
#include <cstdint>
#include <map>
#include <string>

namespace scancal::coverage {

// Everything anew: the instrument's errors, as considered (scale, tilts, encoder), its calibration, the reference's
// errors, the scan of two balls and a step. E_n by kind of feature; "scale_y": error of its estimate over U.
std::map<std::string, double> TryVerify(uint64_t seed);

struct VerifyCount {
  double within = 0, trials = 0, squares = 0;  // squares: of E_n
};
std::map<std::string, VerifyCount> CountVerified(size_t sets);

}  // namespace scancal::coverage

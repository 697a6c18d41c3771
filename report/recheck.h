// Whether a calibration.json says what its own data say.
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include "io/json_file.h"

namespace scancal {

struct RecheckChoice {
  // Keys of the file that are not compared: what was read, where it came from, and what the page takes from the
  // recomputation itself.
  std::set<std::string> without = {"data",     "inputs",  "command", "version",
                                   "messages", "compare", "surface", "residuals"};
  // As one version writes it. false: of another version, whose keys may be others; those that both have are compared.
  bool same_keys = true;
};

struct Difference {
  std::string where, here, there;  // "u of M", as the file says, as its data say
};

struct Agreement {
  int64_t numbers = 0;              // that were compared
  double largest_in_u = 0;          // of their differences, as far as they have a u
  std::optional<Difference> first;  // beyond what rounding explains; of the parameters before all else
};

// The keys of a result against ToJson of what was computed again of its data. An estimate, its u, and what is read as
// it is (a trial's mean, the result without a target) may differ by 1e-6 of u, since another processor rounds
// otherwise; a place (a plane's distance, a point of the volume) by 1e-9 of itself, any other number by 1e-6, in a list
// of the largest in it. Words and counts must be the same, and so must their number.
Agreement CompareResults(const Json& found, const Json& again, const RecheckChoice& choice = {});

}  // namespace scancal

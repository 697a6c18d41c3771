#include "solver/random.h"
#include <Random123/philox.h>
#include <cmath>
#include <numbers>

namespace scancal {

Random::Random(uint64_t seed, uint64_t stream) : seed_(seed), stream_(stream) {}

uint64_t Random::Next() {
  if (left_ == 0) {
    const r123::Philox2x64 philox;
    // The stream is the high word of the counter, the seed the key.
    const r123::Philox2x64::ctr_type out = philox({{counter_++, stream_}}, {{seed_}});
    pending_[0] = out[0];
    pending_[1] = out[1];
    left_ = 2;
  }
  return pending_[--left_];
}

double Random::Uniform() { return (static_cast<double>(Next() >> 11) + 0.5) * 0x1p-53; }

// Box and Muller (1958).
double Random::Normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2 * std::log(Uniform())), angle = 2 * std::numbers::pi * Uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

}  // namespace scancal

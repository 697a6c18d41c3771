// Random numbers that are the same everywhere: Philox (Salmon et al. 2011, Parallel Random Numbers: As Easy as 1, 2,
// 3), a function of key and counter.
#pragma once
#include <cstdint>

namespace scancal {

// Streams of one seed are independent; the n-th number of a stream does not depend on threads, order or library.
class Random {
 public:
  Random(uint64_t seed, uint64_t stream);
  double Uniform();  // (0, 1)
  double Normal();   // mean 0, standard deviation 1

 private:
  uint64_t Next();
  uint64_t seed_, stream_, counter_ = 0;
  uint64_t pending_[2] = {0, 0};
  int left_ = 0;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace scancal

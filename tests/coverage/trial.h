// One data set through the whole estimation, as a user's would go.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>
#include "tests/coverage/oracle.h"
#include "tests/coverage/rows.h"

namespace scancal::coverage {

struct Trial {  // M, N; mm
  Eigen::Vector2d error = {0, 0};
  Eigen::Vector2d U = {0, 0}, U_naive = {0, 0}, U_clustered = {0, 0};  // 0: no result
  Guess oracle;
  std::vector<std::string> unreliable, warnings;  // as printed; the refusal where there is no result
};

// Simulates the row's scene with this seed, sets points aside, compresses, searches, fits, estimates the variances,
// fits with weights, and judges.
Trial Try(const Row& row, const Oracle& oracle, uint64_t seed);

// Sets 0, 1, ... of a row, the same for any number of threads. number: of the row; done: told after every set, by any
// thread.
std::vector<Trial> TryAll(const Row& row, size_t number, size_t sets, int threads,
                          const std::function<void()>& done = {});

}  // namespace scancal::coverage

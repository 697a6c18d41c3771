// What drawing anew says of a result: bootstrap and Monte Carlo, as numbers of its Calibration.
#pragma once
#include <cstdint>
#include <functional>
#include "solver/calibrate.h"
#include "solver/uncertainty/drawn_problem.h"

namespace scancal {

struct MonteCarloChoice {
  int64_t trials = 0;  // at two digits the most; 0: none
  uint64_t seed = 1;
  int digits = 1;   // significant digits of u at which value +- U is validated: 1 or 2
  int threads = 0;  // 0: one a core
};

// Adds u_bootstrap to every estimated parameter of what Summarize made of the solution and, if trials are asked for,
// the Monte Carlo summary with its verdict on value +- U; a FAIL is a warning too. Monte Carlo is for weighted
// solutions: only they say how large all noise is. progress: fraction done, of the Monte Carlo.
void AddResampling(const Solution& solution, const MonteCarloChoice& choice,
                   const std::function<void(double)>& progress, Calibration* result);

}  // namespace scancal

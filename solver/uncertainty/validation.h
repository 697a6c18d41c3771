// Is value +- U confirmed by Monte Carlo? JCGM 101, clauses 7.7, 7.9 and 8. Plain numbers: knows no problem.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace scancal {

enum class Verdict { kPass, kFail, kUndecided };
const char* Name(Verdict verdict);  // "PASS", "FAIL", "UNDECIDED"

struct GumInterval {  // of one quantity, 95 %: value - U to value + U
  double value = 0, u = 0, U = 0;
};

// delta = 10^l / 2, where u = c 10^l to `digits` significant digits, c whole (7.9.2): 0.5 of the last digit of u. 0 if
// u is not finite and greater than zero.
double NumericalTolerance(double u, int digits);

struct Validation {
  double mean = 0, deviation = 0;  // of the trials
  double low = 0, high = 0;        // probabilistically symmetric 95 % interval
  double d_low = 0, d_high = 0;    // how far the ends of value +- U are from it
  double tolerance = 0;            // delta
  Verdict verdict = Verdict::kUndecided;
};

// The interval by order statistics (7.7) and clause 8.1: confirmed where d_low and d_high are at most delta. PASS and
// FAIL only where two standard errors of the ends, as the ranks of the sorted trials have them, cannot turn the answer;
// else UNDECIDED, whose remedy is more trials. trials: at least 40.
Validation Validate(std::span<const double> trials, const GumInterval& gum, int digits);

struct AdaptiveSample {
  Eigen::MatrixXd trials;  // trials x quantities
  bool stable = false;     // else `most` was reached before
};

// The adaptive procedure of clause 7.9.4: blocks of 10^4 trials until twice the standard deviation of the averages over
// blocks of mean, deviation and both ends is below delta / 5 (8.2) for every quantity. sample(first, trials): the
// trials of these numbers; a block may be short of some. delta is that of the stated u, as in Validate: so one
// tolerance rules. At two digits this takes 3e5 (u = 1.0) to 3e7 trials (u = 9.9).
AdaptiveSample SampleUntilStable(const std::function<Eigen::MatrixXd(int64_t first, int64_t trials)>& sample,
                                 std::span<const GumInterval> gum, int digits, int64_t most);

}  // namespace scancal

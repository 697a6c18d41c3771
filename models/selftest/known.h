// Answers that are known, and how far a computed number agrees with them.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "solver/results.h"

namespace scancal {

// A number as it was printed: "-2.5235058043E+03" has 11 digits.
struct Known {
  double value = 0;
  double digits = 0;      // significant ones, at most the 16 of a double
  double last_place = 0;  // digits of agreement within one unit of the last place printed
};

std::optional<Known> ParseKnown(std::string_view text);  // nothing if it is no number other than zero

inline constexpr double kAllDigits = 99;  // required: all that were printed, to one unit of the last place

// The number that comes closest to failing against its known one, as printed. CHECKs that the texts are numbers.
Digits Compare(const Eigen::VectorXd& found, const std::vector<std::string>& known, double required);

}  // namespace scancal

// What robust scales are made of.
#pragma once
#include <vector>

namespace scancal {

inline constexpr double kMadToSigma =
    1.4826;  // median absolute deviation to standard deviation, of a normal distribution

double Median(std::vector<double> values);  // the upper one of an even number; 0 of none

}  // namespace scancal

// What is known of the parameters, and where it comes from, as text.
#pragma once
#include <string>
#include "solver/calibration.h"

namespace scancal {

// Value and uncertainties of every parameter that is estimated, considered or held off its nominal value.
std::string ParametersText(const Calibration& calibration);
// Where u comes from: the budget, and its sum. With many parameters one line for each, the shares across.
std::string BudgetText(const Calibration& calibration);
// Which target moves which parameter, in units of its u.
std::string LeaveOneOutText(const Calibration& calibration);

}  // namespace scancal

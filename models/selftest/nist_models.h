// The model functions of NIST's certified nonlinear regressions.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "models/selftest/regression.h"

namespace scancal {

struct NistModel {
  const char* name;  // of the data set; its file is NAME.dat
  int parameters = 0;
  Problem (*pose)(const std::vector<double>& start, std::vector<Observation> observations) = nullptr;
  int predictors = 1;
  bool log_response = false;    // the model is one of log(y)
  double deviation_digits = 6;  // required
  const char* note = "";        // why fewer
};

std::span<const NistModel> NistModels();  // all 27, in alphabetical order

}  // namespace scancal

// Cases with known answers, which prove the program's arithmetic.
#pragma once
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "io/result.h"
#include "solver/problem.h"
#include "solver/selftest.h"

namespace scancal::selftest {

std::vector<SelftestRow> OwnCases();  // the GUM's examples, planes and spheres: no file is needed

// NIST's 27 certified regressions; the folder holds their files, Bennett5.dat and so on.
Result<std::vector<SelftestRow>> NistCases(const std::filesystem::path& folder);

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

// The worked examples of the GUM (JCGM 100:2008, Annex H): inputs and published results.
SelftestRow CheckGaugeBlock();   // H.1: budget, effective degrees of freedom, coverage factor
SelftestRow CheckImpedance();    // H.2: correlated inputs, correlated results
SelftestRow CheckThermometer();  // H.3: a calibration line, and a value predicted by it

// Orthogonal planes and geometric spheres through small point sets whose least squares answers are known to 40 digits.
struct ExactShape {
  enum Kind { kPlane, kSphere };
  std::string name;
  Kind kind = kPlane;
  double known_radius = 0;  // mm; 0: estimated
  std::vector<Eigen::Vector3d> points;
  std::vector<std::string> values;      // plane: n, d > 0 of n . p = d; sphere: centre, radius unless known
  std::vector<std::string> deviations;  // of the values
};

std::vector<ExactShape> ExactShapes();  // computed by scripts/selftest_digits

SelftestRow Check(const ExactShape& shape);

struct Observation {
  double y = 0;
  std::array<double, 2> x = {};  // one or two predictors
};

// NIST's certified nonlinear regressions (Statistical Reference Datasets): their functions,
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

// and what their files hold.
struct NistData {
  std::string level;                            // "Higher"
  std::vector<double> start;                    // "Start 2", the nearer one
  std::vector<std::string> values, deviations;  // certified, as printed
  std::vector<Observation> observations;
  std::string note;  // a misprint that was corrected
};

// The header of a file says between which lines the parameters and the data stand. Wrong cells are named by line.
Result<NistData> ReadNist(const std::filesystem::path& file, const NistModel& model);

// From start 2, against the certified values: at least 8 digits of the parameters and 6 of their standard deviations.
SelftestRow Check(const NistModel& model, const NistData& data);

}  // namespace scancal::selftest

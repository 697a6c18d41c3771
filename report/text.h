// Results as text: for the terminal, and points with their uncertainty for programs.
#pragma once
#include <string>
#include <vector>
#include "solver/calibration.h"
#include "solver/results.h"

namespace scancal {

// wide: every column and table. Else, of many quantities and columns, what tells most in 100 columns.
std::string ToText(const Calibration& calibration, bool wide = true);
std::string ToText(const Comparison& comparison, bool wide = true);
std::string ToText(const Propagation& propagation);
std::string ToText(const Selftest& selftest);
std::string ToText(const Verification& verification);

// One line a point, with its distance from the one before where there are distances. mm and deg; a table of points that
// can be read again.
std::string ToCsv(const Propagation& propagation);
std::string ToCsv(const Verification& verification);  // a line a feature, mm

class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header);
  void Add(std::vector<std::string> row);  // as long as the header
  std::string Text() const;                // the first column to the left, the others to the right, under a rule

 private:
  std::vector<std::vector<std::string>> rows_;
};

// "123.0021(54)": the value to the second digit of u, which stands in units of the last digit (GUM 7.2.2). Without a u
// that is finite and greater than zero: six digits.
std::string Concise(double value, double u);
std::string Count(double number);                   // whole, without exponent
std::string Significant(double value, int digits);  // never in exponents between 1e-4 and 1e6

std::string CoverageText();  // "95 %", of kCoverage

// Lines that are longer, broken at blanks, what follows two blanks in; tables as they are.
std::string Wrapped(const std::string& text, size_t columns);

}  // namespace scancal

// Aligned columns of text.
#pragma once
#include <string>
#include <vector>

namespace scancal {

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

}  // namespace scancal

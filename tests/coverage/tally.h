// How often stated intervals hold the truth, and the table that says so.
#pragma once
#include <string>
#include <vector>
#include "tests/coverage/trial.h"

namespace scancal::coverage {

struct Tally {  // over the data sets of a row, of M and N
  double sets = 0;
  Eigen::Vector2d stated = {0, 0}, naive = {0, 0}, clustered = {0, 0};  // share whose interval holds the truth
  Eigen::Vector2d width = {0, 0};                                       // median of U / (1.96 sigma of the oracle)
  Eigen::Vector2d oracle = {0, 0};                                      // rms error of the oracle / its sigma
  double unreliable = 0;                                                // share
};
Tally Count(const std::vector<Trial>& trials);

bool Holds(const Row& row, const Tally& tally);

class Table {
 public:
  void Add(const Row& row, const Tally& tally);
  std::string Markdown() const;

 private:
  std::vector<std::vector<std::string>> lines_;
};

}  // namespace scancal::coverage

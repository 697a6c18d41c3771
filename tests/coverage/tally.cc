#include "tests/coverage/tally.h"
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include "models/median.h"

namespace scancal::coverage {
namespace {

constexpr double kNormal = 1.959964;

std::string Percent(const Eigen::Vector2d& share) {
  return fmt::format("{:.1f} / {:.1f}", 100 * share[0], 100 * share[1]);
}

std::string WithError(double share, double sets) {
  return fmt::format("{:.1f} ± {:.1f} %", 100 * share, 100 * std::sqrt(share * (1 - share) / sets));
}

std::string Wanted(const Row& row) {
  const std::string coverage = row.most < 1 ? fmt::format("{:g}-{:g} %", 100 * row.least, 100 * row.most)
                                            : fmt::format("at least {:g} %", 100 * row.least);
  return std::isfinite(row.widest) ? coverage + fmt::format(", width at most {:g}", row.widest) : coverage;
}

}  // namespace

Tally Count(const std::vector<Trial>& trials) {
  Tally tally;
  tally.sets = static_cast<double>(trials.size());
  for (Eigen::Index k = 0; k < 2; ++k) {
    std::vector<double> widths;
    for (const Trial& trial : trials) {
      const double error = std::abs(trial.error[k]);
      tally.stated[k] += error < trial.U[k];
      tally.naive[k] += error < trial.U_naive[k];
      tally.clustered[k] += error < trial.U_clustered[k];
      tally.oracle[k] += std::pow(trial.oracle.error[k] / trial.oracle.sigma[k], 2);
      widths.push_back(trial.U[k] / (kNormal * trial.oracle.sigma[k]));
    }
    tally.width[k] = Median(widths);
  }
  for (Eigen::Vector2d* sum : {&tally.stated, &tally.naive, &tally.clustered, &tally.oracle}) *sum /= tally.sets;
  tally.oracle = tally.oracle.cwiseSqrt();
  for (const Trial& trial : trials) tally.unreliable += !trial.unreliable.empty() / tally.sets;
  return tally;
}

bool Holds(const Row& row, const Tally& tally) {
  return tally.stated.minCoeff() >= row.least && tally.stated.maxCoeff() <= row.most &&
         tally.width.maxCoeff() <= row.widest;
}

void Table::Add(const Row& row, const Tally& tally) {
  lines_.push_back(
      {row.name, fmt::format("{:g}", tally.sets), WithError(tally.stated[0], tally.sets),
       WithError(tally.stated[1], tally.sets), Percent(tally.naive), Percent(tally.clustered),
       fmt::format("{:.3f} / {:.3f}", tally.width[0], tally.width[1]),
       fmt::format("{:.3f} / {:.3f} ± {:.3f}", tally.oracle[0], tally.oracle[1], std::sqrt(0.5 / tally.sets)),
       fmt::format("{:.1f}", 1000 * tally.unreliable), Wanted(row), Holds(row, tally) ? "yes" : "NO"});
}

std::string Table::Markdown() const {
  std::vector<std::vector<std::string>> cells = {{"scene", "sets", "M held", "N held", "naive M / N, %",
                                                  "clustered M / N, %", "width M / N", "oracle M / N", "unreliable, ‰",
                                                  "wanted", "holds"}};
  cells.emplace_back(cells[0].size(), "---");
  cells.insert(cells.end(), lines_.begin(), lines_.end());
  std::string text;
  for (const auto& line : cells) {
    for (const std::string& cell : line) text += "| " + cell + " ";
    text += "|\n";
  }
  return text;
}

}  // namespace scancal::coverage

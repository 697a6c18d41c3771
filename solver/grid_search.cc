#include "solver/grid_search.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include "solver/parallel.h"

namespace scancal {
namespace {

struct Minimum {
  double value = std::numeric_limits<double>::infinity();  // the printed start, S = 100, depends on the unit
  int64_t i = 0, j = 0;
  void Offer(double candidate, int64_t at_i, int64_t at_j) {
    if (candidate < value) *this = {candidate, at_i, at_j};
  }
};

}  // namespace

std::array<int64_t, 2> GridBox::Nodes() const {
  std::array<int64_t, 2> nodes{};
  for (size_t k = 0; k < 2; ++k) nodes[k] = static_cast<int64_t>(std::floor((upper[k] - lower[k]) / step + 1e-6)) + 1;
  return nodes;
}

std::array<double, 2> GridBox::At(int64_t i, int64_t j) const {
  return {lower[0] + static_cast<double>(i) * step, lower[1] + static_cast<double>(j) * step};
}

GridResult GridSearch(const GridBox& box, int targets,
                      const std::function<void(const std::array<double, 2>& at, std::span<double> rmse)>& rmse,
                      int threads, const std::function<void(double)>& progress) {
  const auto [rows, columns] = box.Nodes();
  // Minima of the mean over all targets, then over all but one, per chunk of rows; merged in order of the rows.
  threads = static_cast<int>(std::clamp<int64_t>(threads, 1, rows));
  std::vector<std::vector<Minimum>> found(threads, std::vector<Minimum>(targets + 1));
  const auto search = [&, rows = rows, columns = columns](int chunk) {
    std::vector<Minimum>& minima = found[chunk];
    std::vector<double> values(targets);
    const int64_t first = rows * chunk / threads, last = rows * (chunk + 1) / threads;
    for (int64_t i = first; i < last; ++i) {
      for (int64_t j = 0; j < columns; ++j) {
        rmse(box.At(i, j), values);
        const double sum = std::accumulate(values.begin(), values.end(), 0.0);
        minima[0].Offer(sum / targets, i, j);
        for (int t = 0; targets > 1 && t < targets; ++t) minima[t + 1].Offer((sum - values[t]) / (targets - 1), i, j);
      }
      if (chunk == 0 && progress) progress(static_cast<double>(i + 1) / static_cast<double>(last));
    }
  };
  InParallel(static_cast<size_t>(threads), threads, [&](size_t chunk) { search(static_cast<int>(chunk)); });
  for (int chunk = 1; chunk < threads; ++chunk)
    for (int t = 0; t <= targets; ++t) found[0][t].Offer(found[chunk][t].value, found[chunk][t].i, found[chunk][t].j);

  const auto node = [&, rows = rows, columns = columns](const Minimum& minimum) {
    const bool edge = (rows > 2 && (minimum.i == 0 || minimum.i == rows - 1)) ||
                      (columns > 2 && (minimum.j == 0 || minimum.j == columns - 1));
    return GridNode{box.At(minimum.i, minimum.j), minimum.value, edge};
  };
  GridResult result{rows * columns, node(found[0][0]), {}};
  for (int t = 0; targets > 1 && t < targets; ++t) result.without.push_back(node(found[0][t + 1]));
  return result;
}

}  // namespace scancal

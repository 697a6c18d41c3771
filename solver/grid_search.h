// Minimise over a box, step by step: Zhao et al. 2021, Algorithm 1.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace scancal {

struct GridBox {  // two parameters; the nodes are lower + i step, both ends included
  std::array<double, 2> lower{}, upper{};
  double step = 1;
  std::array<int64_t, 2> Nodes() const;
  std::array<double, 2> At(int64_t i, int64_t j) const;
};

struct GridNode {
  std::array<double, 2> at{};
  double value = 0;
  bool on_edge = false;  // of a side that is longer than one step
};

struct GridResult {
  int64_t nodes = 0;
  GridNode best;                  // of the mean over all targets (eq. 15)
  std::vector<GridNode> without;  // per target: of the mean over the others, from the same pass
};

// rmse: writes one value per target at a node (eq. 14). The first of equal minima in the paper's order (M slow, N fast)
// wins, for any number of threads. progress: told the finished fraction, may be empty.
GridResult GridSearch(const GridBox& box, int targets,
                      const std::function<void(const std::array<double, 2>& at, std::span<double> rmse)>& rmse,
                      int threads = 1, const std::function<void(double)>& progress = {});

}  // namespace scancal

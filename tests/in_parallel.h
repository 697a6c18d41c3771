// Many independent tries on a few threads.
#pragma once
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace scancal {

// work(0) .. work(count - 1), each once, in any order.
inline void InParallel(size_t count, int threads, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  const auto run = [&] {
    for (size_t k = next++; k < count; k = next++) work(k);
  };
  std::vector<std::jthread> others;
  for (int k = 1; k < threads; ++k) others.emplace_back(run);
  run();
}

}  // namespace scancal

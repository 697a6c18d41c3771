// Many independent pieces of work on a few threads.
#pragma once
#include <atomic>
#include <functional>
#include <thread>
#include <vector>

namespace scancal {

// work(0) .. work(count - 1), each once, in any order, by so many threads (0: one a core).
inline void InParallel(size_t count, int threads, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  const auto run = [&] {
    for (size_t k = next++; k < count; k = next++) work(k);
  };
  std::vector<std::jthread> others;
  if (threads == 0) threads = static_cast<int>(std::thread::hardware_concurrency());
  for (int k = 1; k < threads && static_cast<size_t>(k) < count; ++k) others.emplace_back(run);
  run();
}

}  // namespace scancal

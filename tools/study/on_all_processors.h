// Work that falls into independent pieces, shared out.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace sinew::study {

/// work(n) for n from 0 up to `count`, on all processors.
template <class Work>
void on_all_processors(int count, const Work& work) {
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int n; (n = next++) < count;) work(n);
  };
  std::vector<std::thread> others(std::max(1u, std::thread::hardware_concurrency()) - 1);
  for (std::thread& thread : others) thread = std::thread(take);
  take();
  for (std::thread& thread : others) thread.join();
}

}  // namespace sinew::study

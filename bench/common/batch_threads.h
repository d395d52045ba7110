#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "bench/common/ray_sets.h"

namespace carousel::bench {

/// Calls `trace(batch)` for each batch of the set, shared out over `threads` threads as they become free.
/// Each thread makes its own `trace` by calling `make_trace()`, so what that holds is not shared.
template <class MakeTrace>
void for_each_batch(const RaySet& rays, int threads, const MakeTrace& make_trace) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    auto trace = make_trace();
    // Relaxed: the counter hands out batches and guards no data.
    for (std::size_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < rays.batches.size();)
      trace(rays.batches[i]);
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work);
  work();
}

}  // namespace carousel::bench

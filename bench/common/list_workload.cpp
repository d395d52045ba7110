#include "bench/common/list_workload.h"

#include <algorithm>

namespace carousel::bench {

Workload::Generated ListWorkload::generate(WorkerId, std::size_t max_rays, RayBatch& out) {
  // Relaxed: the cursor hands out disjoint ranges and guards no data; the rays were there before the threads.
  const std::size_t begin = std::min(next_.fetch_add(max_rays, std::memory_order_relaxed), rays_.size);
  const std::size_t end = std::min(begin + max_rays, rays_.size);
  if (begin == 0) started_ = std::chrono::steady_clock::now();  // one caller gets the range that starts at 0
  for (std::size_t i = begin; i < end;) {
    const RayBatch& batch = rays_.batches[i / RaySet::kBatchRays];
    const std::size_t offset = i % RaySet::kBatchRays, count = std::min(end - i, batch.size() - offset);
    const auto first = batch.begin() + static_cast<std::ptrdiff_t>(offset);
    out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(count));
    i += count;
  }
  return {end - begin, end == rays_.size};
}

void ListWorkload::shade(WorkerId, const HitBatch& completed, RayBatch&) {
  for (const RayResult& result : completed) hits_[result.tag.path] = result.hit;
}

}  // namespace carousel::bench

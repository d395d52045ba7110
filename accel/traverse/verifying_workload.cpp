#include "accel/traverse/verifying_workload.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace carousel::accel {

bool same_result(const RayResult& a, const RayResult& b) {
  if (a.tag.kind == RayKind::kShadow) return a.hit.valid() == b.hit.valid();
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.hit.instance == b.hit.instance && a.hit.primitive == b.hit.primitive && bits(a.hit.t) == bits(b.hit.t) &&
         bits(a.hit.u) == bits(b.hit.u) && bits(a.hit.v) == bits(b.hit.v);
}

void VerifyingWorkload::shade(WorkerId worker, const HitBatch& completed, RayBatch& out) {
  // Relaxed: plain sums, read when the engine's threads have been joined.
  compared_.fetch_add(completed.size(), std::memory_order_relaxed);
  for (const RayResult& result : completed) {
    const RayResult expected{result.ray, oracle_.trace({result.ray, result.tag}), result.tag};
    if (!same_result(result, expected)) note(result, expected);
  }
  inner_.shade(worker, completed, out);
}

void VerifyingWorkload::note(const RayResult& got, const RayResult& expected) {
  mismatches_.fetch_add(1, std::memory_order_relaxed);
  const std::lock_guard lock(example_mutex_);
  if (!example_) example_ = Mismatch{got, expected};
}

void VerifyingWorkload::compare_nearest(const RayResult& ray, std::span<const Hit> hits) {
  const std::vector<Hit> expected = oracle_.nearest({ray.ray, ray.tag}, nearest_);
  for (std::size_t i = 0; i < std::max(hits.size(), expected.size()); ++i) {
    const RayResult got{ray.ray, i < hits.size() ? hits[i] : Hit{}, ray.tag},
        wanted{ray.ray, i < expected.size() ? expected[i] : Hit{}, ray.tag};
    if (!same_result(got, wanted)) return note(got, wanted);
  }
}

}  // namespace carousel::accel

#include "accel/traverse/verifying_workload.h"

#include <bit>

#include "accel/traverse/reference_tracer.h"

namespace carousel::accel {

bool same_result(const RayResult& a, const RayResult& b) {
  if (a.tag.kind == RayKind::kShadow) return a.hit.valid() == b.hit.valid();
  const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
  return a.hit.instance == b.hit.instance && a.hit.primitive == b.hit.primitive && bits(a.hit.t) == bits(b.hit.t) &&
         bits(a.hit.u) == bits(b.hit.u) && bits(a.hit.v) == bits(b.hit.v);
}

void VerifyingWorkload::shade(WorkerId worker, const HitBatch& completed, RayBatch& out) {
  RayBatch again;
  again.reserve(completed.size());
  for (const RayResult& result : completed) again.push_back({result.ray, result.tag});
  HitBatch expected;
  expected.reserve(completed.size());
  IntersectionCounts counts;
  trace_depth_first(accel_, again, expected, counts);
  // Relaxed: plain sums, read when the engine's threads have been joined.
  compared_.fetch_add(completed.size(), std::memory_order_relaxed);
  for (std::size_t i = 0; i < completed.size(); ++i) {
    if (same_result(completed[i], expected[i])) continue;
    mismatches_.fetch_add(1, std::memory_order_relaxed);
    const std::lock_guard lock(example_mutex_);
    if (!example_) example_ = Mismatch{completed[i], expected[i]};
  }
  inner_.shade(worker, completed, out);
}

}  // namespace carousel::accel

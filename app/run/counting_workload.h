#pragma once

#include <atomic>
#include <cstdint>

#include "core/types/workload.h"

namespace carousel::app {

/// Counts how many rays another workload has generated: how far a frame has come, for the progress line.
class CountingWorkload final : public Workload {
 public:
  explicit CountingWorkload(Workload& inner) : inner_(inner) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    const Generated made = inner_.generate(worker, max_rays, out);
    // Relaxed: a number to look at.
    generated_.fetch_add(made.rays, std::memory_order_relaxed);
    return made;
  }
  std::uint32_t extra_effects(const RayResult& result) const override { return inner_.extra_effects(result); }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    inner_.shade(worker, completed, out);
  }

  std::uint64_t generated() const { return generated_.load(std::memory_order_relaxed); }

 private:
  Workload& inner_;
  std::atomic<std::uint64_t> generated_{0};
};

}  // namespace carousel::app

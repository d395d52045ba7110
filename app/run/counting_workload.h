#pragma once

#include <atomic>
#include <cstdint>

#include "core/types/wrapped_workload.h"

namespace carousel::app {

/// Counts the rays that another workload has generated, for the progress line.
class CountingWorkload final : public WrappedWorkload {
 public:
  explicit CountingWorkload(Workload& inner) : WrappedWorkload(inner) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    const Generated made = inner_.generate(worker, max_rays, out);
    // Relaxed: the number is only displayed.
    generated_.fetch_add(made.rays, std::memory_order_relaxed);
    return made;
  }

  std::uint64_t generated() const { return generated_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> generated_{0};
};

}  // namespace carousel::app

#pragma once

#include <atomic>
#include <cstdint>

#include "core/types/workload.h"

namespace carousel::app {

/// Counts the rays that another workload has generated, for the progress line.
class CountingWorkload final : public Workload {
 public:
  explicit CountingWorkload(Workload& inner) : inner_(inner) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    const Generated made = inner_.generate(worker, max_rays, out);
    // Relaxed: the number is only displayed.
    generated_.fetch_add(made.rays, std::memory_order_relaxed);
    return made;
  }
  ShadeWork extra_work(const RayResult& result) const override { return inner_.extra_work(result); }
  std::uint32_t shader(const RayResult& result) const override { return inner_.shader(result); }
  PathMemory path_memory(const RayTag& tag) const override { return inner_.path_memory(tag); }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    inner_.shade(worker, completed, out);
  }

  std::uint64_t generated() const { return generated_.load(std::memory_order_relaxed); }

 private:
  Workload& inner_;
  std::atomic<std::uint64_t> generated_{0};
};

}  // namespace carousel::app

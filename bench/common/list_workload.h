#pragma once

#include <atomic>
#include <chrono>

#include "bench/common/ray_sets.h"
#include "core/types/workload.h"

namespace carousel::bench {

/// Generates the rays of a set in order and records their hits. It does nothing else, so that only the engine is
/// measured.
class ListWorkload final : public Workload {
 public:
  /// Keeps references; `hits` has one place a ray.
  ListWorkload(const RaySet& rays, HitList& hits) : rays_(rays), hits_(hits) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  /// Time of the first request for rays: only filling the first packet is left to do then.
  std::chrono::steady_clock::time_point started() const { return started_; }

 private:
  const RaySet& rays_;
  HitList& hits_;
  std::atomic<std::size_t> next_{0};
  std::chrono::steady_clock::time_point started_;
};

}  // namespace carousel::bench

#pragma once

#include <atomic>
#include <chrono>

#include "bench/common/ray_sets.h"
#include "core/types/workload.h"

namespace carousel::bench {

/// Hands out the rays of a set in order and writes down their hits. Does nothing else, so that what is
/// measured is the engine.
class ListWorkload final : public Workload {
 public:
  /// Keeps references; `hits` has one place a ray.
  ListWorkload(const RaySet& rays, HitList& hits) : rays_(rays), hits_(hits) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  /// When rays were first asked for: nothing is left to do then before the first packet but to fill it.
  std::chrono::steady_clock::time_point started() const { return started_; }

 private:
  const RaySet& rays_;
  HitList& hits_;
  std::atomic<std::size_t> next_{0};
  std::chrono::steady_clock::time_point started_;
};

}  // namespace carousel::bench

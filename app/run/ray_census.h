#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/bounce_counts.h"
#include "core/types/wrapped_workload.h"
#include "report/sections/rays.h"
#include "report/sections/tests.h"
#include "ringbus/transport/transport.h"

namespace carousel::app {

/// Counts the rays of another workload by kind and bounce and keeps some of them, to be traced depth-first when the
/// run is over. Counts and choice depend on the rays and their hits alone.
class RayCensus final : public WrappedWorkload {
 public:
  /// Keeps a reference to `inner`. One ray in `one_in`, a power of two, is kept.
  RayCensus(Workload& inner, std::size_t workers, std::uint64_t one_in)
      : WrappedWorkload(inner), one_in_(one_in), workers_(workers) {}

  /// The part of the rays of a run of about `rays` that is worth tracing again: some 32,768 of them.
  static std::uint64_t one_in(std::uint64_t rays);

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  // When nothing runs any more.

  /// Joins the rays that the ranks of a run have counted and kept. Every rank calls, and every one gets all.
  void join(ringbus::Transport& ranks);

  std::vector<report::RayBounce> by_bounce() const;
  /// Traces the kept rays on the calling thread.
  report::DepthFirst depth_first(const accel::Accel& accel) const;

 private:
  struct alignas(128) Worker {
    std::vector<BounceCounts> bounces;
    RayBatch kept;

    BounceCounts& at(std::size_t bounce) {
      if (bounces.size() <= bounce) bounces.resize(bounce + 1);
      return bounces[bounce];
    }
  };

  bool keeps(const Ray& ray) const;

  std::uint64_t one_in_;
  std::vector<Worker> workers_;
};

}  // namespace carousel::app

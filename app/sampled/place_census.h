#pragma once

#include <cstdint>
#include <vector>

#include "app/run/render_job.h"
#include "core/types/wrapped_workload.h"

namespace carousel::app {

/// Counts the rays of each place of a job's sample. For the cycle engine, which calls it from one thread.
class PlaceCensus final : public WrappedWorkload {
 public:
  /// Keeps references to both; `job` has a sample.
  PlaceCensus(Workload& inner, const RenderJob& job);

  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& ray : completed) ++rays_[place_of_[job_.piece_of(ray.tag.path)]];
    inner_.shade(worker, completed, out);
  }

  const std::vector<std::uint64_t>& paths() const { return paths_; }  ///< by place
  const std::vector<std::uint64_t>& rays() const { return rays_; }    ///< completed, by place

 private:
  const RenderJob& job_;
  std::vector<std::uint32_t> place_of_;  // by piece of the frame
  std::vector<std::uint64_t> paths_, rays_;
};

}  // namespace carousel::app

#pragma once

#include <cstdint>
#include <vector>

#include "app/run/render_job.h"

namespace carousel::app {

/// Counts the rays of each place of a job's sample. For the cycle engine, which calls it from one thread.
class PlaceCensus final : public Workload {
 public:
  /// Keeps references to both; `job` has a sample.
  PlaceCensus(Workload& inner, const RenderJob& job);

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    return inner_.generate(worker, max_rays, out);
  }
  ShadeWork extra_work(const RayResult& result) const override { return inner_.extra_work(result); }
  std::uint32_t shader(const RayResult& result) const override { return inner_.shader(result); }
  PathMemory path_memory(const RayTag& tag) const override { return inner_.path_memory(tag); }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& ray : completed) ++rays_[place_of_[job_.piece_of(ray.tag.path)]];
    inner_.shade(worker, completed, out);
  }

  const std::vector<std::uint64_t>& paths() const { return paths_; }  ///< by place
  const std::vector<std::uint64_t>& rays() const { return rays_; }    ///< completed, by place

 private:
  Workload& inner_;
  const RenderJob& job_;
  std::vector<std::uint32_t> place_of_;  // by piece of the frame
  std::vector<std::uint64_t> paths_, rays_;
};

}  // namespace carousel::app

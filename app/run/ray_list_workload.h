#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "app/run/all_hits.h"
#include "core/numeric/digest.h"
#include "core/types/workload.h"
#include "shading/camera/path_sample.h"
#include "shading/tracer/ray_recorder.h"

namespace carousel::app {

/// Rays of a list (`workload: {rays_from: FILE}`): each is traced once and causes no other. Ray i counts as
/// pixel i, sample 0; hit k of all its hits as sample k.
class RayListWorkload final : public Workload {
 public:
  /// rays[i].tag.path must be i.
  /// A ray that no hit ends has the hits that `all` holds of it; null: its closest.
  RayListWorkload(RayBatch rays, std::size_t workers, const AllHits* all = nullptr)
      : rays_(std::move(rays)), workers_(workers), all_(all) {}

  /// Sets the recorder, as PathTracer::set_recorder() does.
  void set_recorder(shading::RayRecorder* recorder) { recorder_ = recorder; }

  /// Limits the rays of the list to a sample, as PathTracer::set_sample() limits paths.
  void set_sample(const shading::PathSample* sample) { sample_ = sample; }

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  // The results below are valid once the workers are joined.

  std::array<std::uint64_t, kRayKinds> emitted() const;  ///< by RayKind
  HitsDigest hits_digest() const;
  std::size_t size() const { return rays_.size(); }

 private:
  struct alignas(128) Worker {  // a worker writes to its own cache lines
    std::array<std::uint64_t, kRayKinds> emitted{};
    HitsDigest digest;
  };

  void take_all(WorkerId worker, const RayResult& result);

  const RayBatch rays_;
  std::vector<Worker> workers_;
  const AllHits* all_;
  std::atomic<std::size_t> next_{0};
  shading::RayRecorder* recorder_ = nullptr;
  const shading::PathSample* sample_ = nullptr;  // null: all rays
};

}  // namespace carousel::app

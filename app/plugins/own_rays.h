#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/config/fields/workload.h"
#include "core/config/tree/positions.h"
#include "core/numeric/digest.h"
#include "core/types/workload_offer.h"
#include "shading/tracer/ray_recorder.h"

namespace carousel::app {

/// The rays of a plugin's workload (`workload: {plugin: NAME}`), counted, and with a digest of their hits. A ray counts
/// as a pixel of the number of its path, sample 0.
class OwnRays final : public Workload {
 public:
  /// Makes the workload anew. Throws a ConfigError where the plugin gives up.
  OwnRays(OwnWorkload own, const WorkloadSetup& setup, const KeyPositions& positions);

  /// Sets the recorder, as PathTracer::set_recorder() does.
  void set_recorder(shading::RayRecorder* recorder) { recorder_ = recorder; }
  /// The number of rays that no other ray causes, as the plugin says; at least 1.
  std::uint64_t first_rays() const { return first_rays_; }

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;
  ShadeWork extra_work(const RayResult& result) const override { return inner_->extra_work(result); }
  std::uint32_t shader(const RayResult& result) const override { return inner_->shader(result); }
  ShadeFacts shade_facts(const RayResult& result) const override { return inner_->shade_facts(result); }
  ShadeFacts any_hit_facts(const RayResult& call) const override { return inner_->any_hit_facts(call); }
  PathMemory path_memory(const RayTag& tag) const override { return inner_->path_memory(tag); }

  // The results below are valid once the workers are joined.

  std::array<std::uint64_t, kRayKinds> emitted() const;  ///< by RayKind
  HitsDigest hits_digest() const;

 private:
  struct alignas(128) Worker {  // a worker writes to its own cache lines
    std::array<std::uint64_t, kRayKinds> emitted{};
    HitsDigest digest;
  };
  void count(WorkerId worker, const RayBatch& out, std::size_t from);

  std::unique_ptr<Workload> inner_;
  std::uint64_t first_rays_ = 1;
  std::vector<Worker> workers_;
  shading::RayRecorder* recorder_ = nullptr;
};

}  // namespace carousel::app

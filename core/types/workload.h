#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/types/ids.h"
#include "core/types/ray.h"
#include "core/types/shade_facts.h"

namespace carousel {

/// A ray on its way into the ring.
struct RayRequest {
  Ray ray;
  RayTag tag;
};

/// A completed ray on its way to a shader worker.
struct RayResult {
  Ray ray;
  Hit hit;
  RayTag tag;
  Vec3 light{0};            ///< from the Gaussians in its way
  float transmittance = 1;  ///< share of the light behind them that reaches it
};

/// The work of shading a hit beyond that of a plain surface.
struct ShadeWork {
  std::uint32_t lookups = 0;   ///< filtered texture lookups
  std::uint32_t products = 0;  ///< products, divisions and roots
  friend bool operator==(const ShadeWork&, const ShadeWork&) = default;
};

/// The data that shading keeps of a path.
struct PathMemory {
  std::uint32_t state_bytes = 0;       ///< its state while its rays are in flight; 0 if there is none
  std::optional<std::uint32_t> pixel;  ///< to which it adds its light; absent if there is no picture
};

/// A read of the map of the sky, or of the tables by which light is drawn from it.
struct SkyRead {
  std::uint64_t offset = 0;  ///< from the start of map and tables, which lie in one piece
  std::uint32_t bytes = 0;
  friend bool operator==(const SkyRead&, const SkyRead&) = default;
};

using RayBatch = std::vector<RayRequest>;
using HitBatch = std::vector<RayResult>;

/// Produces rays and consumes their hits. An engine and the reference tracer know nothing else of
/// shading. `worker` names the calling shader worker, 0 <= worker < the count the workload was made for; a
/// worker calls from one thread at a time, different workers may call at the same time. Results must not
/// depend on which worker is called, in what order, or how rays are cut into batches.
class Workload {
 public:
  struct Generated {
    std::size_t rays = 0;   ///< appended to `out`
    bool finished = false;  ///< no generate() call, by anyone, will ever append a ray again
    /// What it has read of the list of rasterised samples, with raster.time: cycles.
    std::vector<DataRead> first_hits{};
  };

  virtual ~Workload() = default;

  /// Appends at most `max_rays` rays that no earlier ray caused. May append none without being finished
  /// (e.g. no path state is free); the caller then tries again after shade() calls.
  virtual Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) = 0;

  /// The work of the effects of the surface that a completed ray has hit, for which a simulated shader worker is
  /// charged besides. Call before the ray is given to shade().
  virtual ShadeWork extra_work(const RayResult& /*result*/) const { return {}; }

  /// The code that shades a completed ray: rays with the same number can be shaded side by side, in one vector of a
  /// simulated shader worker, by kShaderKindNames. Call before the ray is given to shade().
  virtual std::uint32_t shader(const RayResult& /*result*/) const { return 0; }

  /// What a program of a simulated shader worker finds of a completed ray. Call before the ray is given to shade().
  virtual ShadeFacts shade_facts(const RayResult& result) const {
    ShadeFacts facts;
    facts[ShadeFact::kHit] = result.hit.valid() ? 1.0f : 0.0f;
    facts[ShadeFact::kShadow] = result.tag.kind == RayKind::kShadow ? 1.0f : 0.0f;
    facts[ShadeFact::kBounce] = static_cast<float>(result.tag.bounce);
    return facts;
  }

  /// What a program finds of an any-hit call. `call` is the ray, with the place of the call for its hit.
  virtual ShadeFacts any_hit_facts(const RayResult& call) const { return shade_facts(call); }

  /// The places in memory of the path of a ray in flight.
  virtual PathMemory path_memory(const RayTag& /*tag*/) const { return {}; }

  /// Appends what shading a completed ray reads of the sky. Call before the ray is given to shade().
  virtual void sky_reads(const RayResult& /*result*/, std::vector<SkyRead>& /*out*/) const {}

  /// Takes completed rays, in any order and mix, each ray exactly once; appends the rays they give rise to.
  virtual void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) = 0;
};

}  // namespace carousel

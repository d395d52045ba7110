#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/types/ray.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::bench {

/// Rays to be traced again and again. RayTag::path is the ray's place in the set, from 0.
struct RaySet {
  /// Rays of one batch, which a thread claims at once. Small enough that two threads end at nearly the same
  /// time.
  static constexpr std::size_t kBatchRays = 1024;

  std::string name;
  bool any_hit = false;             ///< shadow rays: only whether there is a hit
  bool coherent = false;            ///< neighbours in the set go to the same places
  std::vector<RayBatch> batches{};  ///< all of kBatchRays rays, the last one perhaps shorter
  std::size_t size = 0;

  void push_back(const Ray& ray);
  const RayRequest& operator[](std::size_t i) const { return batches[i / kBatchRays][i % kBatchRays]; }
};

/// One hit a ray, by RayTag::path.
using HitList = std::vector<Hit>;

/// Of a depth-first tracer.
HitList reference_hits(const accel::Accel& accel, const RaySet& rays);

/// The ray sets of a scene:
/// - primary: through every pixel of a square image, tile by tile along a Z curve;
/// - shadow: any hit, from each primary hit to the scene's first light, in the same order;
/// - bounce: from each primary hit to a cosine-weighted direction, in the same order;
/// - shuffled: the same rays in random order;
/// - shuffled-any: the same again, any hit.
/// Equal arguments give the same bits.
std::vector<RaySet> make_ray_sets(const scene::Scene& scene, const accel::Accel& accel, std::uint32_t image_side,
                                  std::uint64_t seed);

}  // namespace carousel::bench

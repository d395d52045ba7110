#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/traverse/oracle_primitive.h"
#include "accel/traverse/ray_check.h"
#include "core/config/config.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Gives each hit of the ray to `take`; instances and primitives in rising order. Every primitive of every instance is
/// tested as accel/traverse/oracle_primitive.h does. Non-opaque materials call `any_hit`, unless it is null. Slow; for
/// small scenes.
template <class Take>
void brute_force_each(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                      const AnyHit* any_hit, const Take& take) {
  if (!valid(request.ray)) return;
  OraclePrimitives oracle(scene, accuracy, any_hit);
  const OracleBoxTest boxes(request.ray, accuracy.box);
  for (std::uint32_t i = 0; i < oracle.instances(); ++i) {
    Aabb model;
    for (std::uint32_t p = 0; p < oracle.primitives(i); ++p) model.extend(oracle.box(i, p));
    oracle.set_model_box(i, model);
    float entry;
    if (oracle.world_box(i).empty() || !boxes.enters(oracle.world_box(i), request.ray.tmax, entry)) continue;
    const OraclePrimitives::LocalRay ray = oracle.local_ray(request.ray, i, entry);
    OraclePrimitives::Candidates found;
    for (std::uint32_t p = 0; p < oracle.primitives(i); ++p) {
      const int count = oracle.cross(ray, p, request.ray.tmax, found);
      for (int k = 0; k < count; ++k)
        if (found[static_cast<std::size_t>(k)].hit.t <= request.ray.tmax &&
            oracle.accepts(request, found[static_cast<std::size_t>(k)]))
          take(found[static_cast<std::size_t>(k)].hit);
    }
  }
}

/// The closest hit.
inline Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy = {},
                       const AnyHit* any_hit = nullptr) {
  Hit best;
  // The first of two hits at one distance stays.
  brute_force_each(scene, request, accuracy, any_hit, [&](const Hit& hit) {
    if (hit.t < best.t || !best.valid()) best = hit;
  });
  return best;
}

/// All hits, in no order.
inline std::vector<Hit> brute_force_all(const scene::Scene& scene, const RayRequest& request,
                                        const AccuracyConfig& accuracy = {}, const AnyHit* any_hit = nullptr) {
  std::vector<Hit> all;
  brute_force_each(scene, request, accuracy, any_hit, [&](const Hit& hit) { all.push_back(hit); });
  return all;
}

}  // namespace carousel::accel

#include "accel/traverse/brute_force.h"

#include "accel/traverse/oracle_primitive.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

namespace {

/// Gives each hit of the ray to `take`; instances and primitives in rising order.
template <class Take>
void every_hit(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
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

}  // namespace

Hit brute_force(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                const AnyHit* any_hit) {
  Hit best;
  // The first of two hits at one distance stays.
  every_hit(scene, request, accuracy, any_hit, [&](const Hit& hit) {
    if (hit.t < best.t || !best.valid()) best = hit;
  });
  return best;
}

std::vector<Hit> brute_force_all(const scene::Scene& scene, const RayRequest& request, const AccuracyConfig& accuracy,
                                 const AnyHit* any_hit) {
  std::vector<Hit> all;
  every_hit(scene, request, accuracy, any_hit, [&](const Hit& hit) { all.push_back(hit); });
  return all;
}

}  // namespace carousel::accel

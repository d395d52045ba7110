#pragma once

#include <algorithm>
#include <limits>

#include "accel/primitive/has_non_opaque.h"
#include "accel/primitive/local_ray.h"
#include "accel/structure/accel.h"
#include "accel/structure/program_hits.h"
#include "accel/structure/sphere.h"
#include "core/numeric/octahedral.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Lowers `hit` to where the ray meets the sphere in a lane of `block`, if that is nearer: a hit as one of a triangle,
/// with the sphere's own box, and for u and v where on the sphere (core/numeric/octahedral.h). The way in is its front,
/// the way out its back.
template <class Slab>
[[gnu::noinline]] bool lower_by_sphere(const Accel& accel, const TriangleBlock& block, std::size_t lane,
                                       const LocalRay<Slab>& ray, Hit& hit) {
  const auto [centre, radius] = sphere_in(block, lane);
  SphereCrossing crossing;
  if (!cross_sphere(ray.origin, ray.direction, centre, radius, crossing)) return false;
  if (accel.gaussians != nullptr) [[unlikely]] {
    // The ray meets the ellipsoid. Its response may be greatest within although the ray begins there, and other rays
    // meet no Gaussians.
    const Hit shape{ray.record->ray.tmin, 0, 0, ray.instance, block.primitive[lane] & kPrimitiveMask};
    static_cast<void>(reported(accel, ray, shape, false));
    return false;
  }
  float entry;
  if (!slab(ray.slab, sphere_box(centre, radius), hit.t, entry)) return false;
  if (NearestRay* const nearest = nearest_of(*ray.record); nearest != nullptr && nearest->fears_strays())
    for (const double t : crossing.t)
      note_stray(*nearest, ray, sphere_box(centre, radius), static_cast<float>(t), entry);
  const std::uint32_t primitive = block.primitive[lane] & kPrimitiveMask;
  const bool calls_any_hit = (block.primitive[lane] & kNonOpaqueBit) != 0;
  constexpr std::uint8_t kCulledBy[2] = {kRayCullFront, kRayCullBack};
  for (int k = 0; k < 2; ++k) {
    const float t = static_cast<float>(crossing.t[k]);
    if (!(t >= ray.slab.tmin && t <= std::numeric_limits<float>::max() && t <= hit.t)) continue;
    if ((ray.record->tag.flags & kCulledBy[k]) != 0) continue;
    const float distance = std::max({t, entry, ray.instance_entry});
    if (!closer(distance, ray.instance, primitive, hit)) return false;
    const Vec2 where = octahedral(crossing.normal[k]);
    const Hit found{distance, where.x, where.y, ray.instance, primitive};
    const std::uint64_t calls = ray.counts->any_hit_calls;
    if (calls_any_hit && !any_hit_accepts(accel, ray, found)) continue;
    if (reported(accel, ray, found, ray.counts->any_hit_calls > calls)) continue;
    hit = found;
    return true;
  }
  return false;
}

/// Likewise where a program reports hits of the ray. The nearest of those that nothing lets pass counts.
template <class Slab>
[[gnu::noinline]] bool lower_by_program(const Accel& accel, const TriangleBlock& block, std::size_t lane,
                                        const LocalRay<Slab>& ray, Hit& hit) {
  const Aabb box = procedural_box(block, lane);
  const Ray local{ray.origin, ray.record->ray.tmin, ray.direction, ray.record->ray.tmax};
  const ProgramHits hits = program_hits(accel.programs[program_in(block, lane)], box, local, ray.counts);
  float entry;
  if (hits.count == 0 || !slab(ray.slab, box, hit.t, entry)) return false;
  const std::uint32_t primitive = block.primitive[lane] & kPrimitiveMask;
  const bool calls_any_hit = (block.primitive[lane] & kNonOpaqueBit) != 0;
  // A program may report a hit a little outside of its box.
  if (NearestRay* const nearest = nearest_of(*ray.record); nearest != nullptr && nearest->fears_strays())
    for (std::size_t k = 0; k < hits.count; ++k) note_stray(*nearest, ray, box, hits.hit[k].t, entry);
  bool lowered = false;
  for (std::size_t k = 0; k < hits.count; ++k) {
    const ProgramHits::One& one = hits.hit[k];
    const std::uint8_t culled_by = one.facing > 0 ? kRayCullFront : one.facing < 0 ? kRayCullBack : 0;
    if (one.t > hit.t || (ray.record->tag.flags & culled_by) != 0) continue;
    const float distance = std::max({one.t, entry, ray.instance_entry});
    if (!closer(distance, ray.instance, primitive, hit)) continue;
    const Hit found{distance, one.where.x, one.where.y, ray.instance, primitive};
    const std::uint64_t calls = ray.counts->any_hit_calls;
    if (calls_any_hit && !any_hit_accepts(accel, ray, found)) continue;
    if (reported(accel, ray, found, ray.counts->any_hit_calls > calls)) continue;
    hit = found;
    lowered = true;
  }
  return lowered;
}

/// One of the two, as the primitive in the lane is a sphere or has a program.
template <class Slab>
bool lower_by_procedural(const Accel& accel, const TriangleBlock& block, std::size_t lane, const LocalRay<Slab>& ray,
                         Hit& hit) {
  return program_in(block, lane) == scene::kNoProgram ? lower_by_sphere(accel, block, lane, ray, hit)
                                                      : lower_by_program(accel, block, lane, ray, hit);
}

}  // namespace carousel::accel

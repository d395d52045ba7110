#pragma once

#include <array>

#include "accel/exact/exact_triangle.h"
#include "accel/primitive/local_ray.h"
#include "accel/structure/accel.h"

namespace carousel::accel {

/// True if a hit there replaces `hit`: the smallest (t, instance, primitive) wins.
[[gnu::always_inline]] inline bool closer(float t, std::uint32_t instance, std::uint32_t primitive, const Hit& hit) {
  return t < hit.t ||
         (t == hit.t && (instance < hit.instance || (instance == hit.instance && primitive < hit.primitive)));
}

/// True if the ray stops at a non-opaque primitive that lies in front of the closest hit so far.
template <class Slab>
[[gnu::noinline]] bool any_hit_accepts(const Accel& accel, const LocalRay<Slab>& ray, const Hit& found) {
  if (accel.any_hit == nullptr || (ray.record->tag.flags & kRayForceOpaque) != 0) return true;
  ++ray.counts->any_hit_calls;
  return accel.any_hit->accepts(ray.record->ray, found.instance, found.primitive, found.u, found.v);
}

/// The same for a triangle, given in the local space, that may be non-opaque or may show a culled side. glTF flips the
/// winding of instances that mirror, so the front is the same side as in model space.
template <class Slab>
[[gnu::noinline]] bool triangle_accepts(const Accel& accel, bool calls_any_hit, const std::array<Vec3, 3>& triangle,
                                        const LocalRay<Slab>& ray, const Hit& found) {
  if (const std::uint8_t culls = ray.record->tag.flags & (kRayCullBack | kRayCullFront); culls != 0) {
    const int facing = exact_facing(ray.direction, triangle);
    if (((culls & kRayCullBack) != 0 && facing < 0) || ((culls & kRayCullFront) != 0 && facing > 0)) return false;
  }
  return !calls_any_hit || any_hit_accepts(accel, ray, found);
}

}  // namespace carousel::accel

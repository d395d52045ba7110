#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>

#include "accel/exact/exact_triangle.h"
#include "accel/primitive/local_ray.h"
#include "accel/primitive/nearest_ray.h"
#include "accel/structure/accel.h"

namespace carousel::accel {

/// True if a hit there replaces `hit`: the smallest (t, instance, primitive) wins.
[[gnu::always_inline]] inline bool closer(float t, std::uint32_t instance, std::uint32_t primitive, const Hit& hit) {
  return t < hit.t ||
         (t == hit.t && (instance < hit.instance || (instance == hit.instance && primitive < hit.primitive)));
}

/// Counts an any-hit call.
template <class Slab>
void note_call(const LocalRay<Slab>& ray, const Hit& found) {
  ++ray.counts->any_hit_calls;
  if (ray.calls != nullptr) ray.calls->push_back({ray.record, found});
}

/// True if the ray stops at a non-opaque primitive that lies in front of the closest hit so far.
template <class Slab>
[[gnu::noinline]] bool any_hit_accepts(const Accel& accel, const LocalRay<Slab>& ray, const Hit& found) {
  if (accel.any_hit == nullptr || (ray.record->tag.flags & kRayForceOpaque) != 0) return true;
  note_call(ray, found);
  return accel.any_hit->accepts(ray.record->ray, found.instance, found.primitive, found.u, found.v);
}

#ifdef CAROUSEL_CHECKED
inline constexpr bool kChecksMicromaps = true;
#else
inline constexpr bool kChecksMicromaps = false;
#endif

/// any_hit_accepts() for a triangle: its opacity micromap answers where it knows. Checked builds throw a
/// std::logic_error if the any-hit call would say something else.
template <class Slab>
[[gnu::noinline]] bool triangle_is_solid(const Accel& accel, const LocalRay<Slab>& ray, const Hit& found) {
  if (accel.micromaps.maps == nullptr || accel.any_hit == nullptr || (ray.record->tag.flags & kRayForceOpaque) != 0)
    return any_hit_accepts(accel, ray, found);
  ++ray.counts->micromap_lookups;
  const scene::OpacityState state = accel.micromaps.maps->state(found.instance, found.primitive, found.u, found.v);
  if (state == scene::OpacityState::kUnknown) return any_hit_accepts(accel, ray, found);
  ++ray.counts->micromap_known;
  const bool solid = state == scene::OpacityState::kOpaque;
  if (kChecksMicromaps &&
      solid != accel.any_hit->accepts(ray.record->ray, found.instance, found.primitive, found.u, found.v))
    throw std::logic_error("an opacity micromap has another answer than the any-hit call");
  return solid;
}

/// Reports a hit of a ray that looks for all of them, or offers it to the buffer of one that looks for several: true,
/// and it does not stop there. `counted` if an any-hit call has been counted for it, which may report it as well.
template <class Slab>
[[gnu::noinline]] bool reported(const Accel& accel, const LocalRay<Slab>& ray, const Hit& found, bool counted) {
  if (NearestRay* const nearest = nearest_of(*ray.record)) {
    ray.counts->buffer_steps += nearest->insert(found);
    return true;
  }
  if ((ray.record->tag.flags & kRayAll) == 0 || accel.all_hits == nullptr) return false;
  if (!counted) note_call(ray, found);
  accel.all_hits->add(ray.record->tag.path, found);
  return true;
}

/// Tells a ray that looks for several hits of one that lies at `t` in `box`, or behind its end (NearestRay).
template <class Slab>
[[gnu::noinline]] void note_stray(NearestRay& nearest, const LocalRay<Slab>& ray, const Aabb& box, float t,
                                  float entry) {
  Slab from_hit = ray.slab;
  from_hit.tmin = std::max({t, entry, ray.instance_entry});
  float at;
  if (!slab(from_hit, box, kInfinity, at)) nearest.stray();
}

/// The flags of rays with which a triangle that is met may be no closest hit after all, and triangle_accepts() decides.
inline constexpr std::uint32_t kFlagsThatDecide = kRayCullBack | kRayCullFront | kRayAll | kRayNearest;

/// triangle_is_solid() and reported() for a triangle, given in the local space, that may be non-opaque or may show a
/// culled side. glTF flips the winding of instances that mirror, so the front is the same side as in model space.
template <class Slab>
[[gnu::noinline]] bool triangle_accepts(const Accel& accel, bool calls_any_hit, const std::array<Vec3, 3>& triangle,
                                        const LocalRay<Slab>& ray, const Hit& found) {
  if (const std::uint8_t culls = ray.record->tag.flags & (kRayCullBack | kRayCullFront); culls != 0) {
    const int facing = exact_facing(ray.direction, triangle);
    if (((culls & kRayCullBack) != 0 && facing < 0) || ((culls & kRayCullFront) != 0 && facing > 0)) return false;
  }
  const std::uint64_t calls = ray.counts->any_hit_calls;
  if (calls_any_hit && !triangle_is_solid(accel, ray, found)) return false;
  return !reported(accel, ray, found, ray.counts->any_hit_calls > calls);
}

}  // namespace carousel::accel

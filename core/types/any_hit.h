#pragma once

#include <cstdint>

#include "core/types/ray.h"

namespace carousel {

/// Decides if a ray hits a non-opaque primitive that it crosses: an alpha-masked one, or an alpha-blended one, which
/// accepts hits by chance. The owner of the ray calls it wherever the ray happens to be tested, perhaps more than once,
/// or not at all if a nearer hit is known: so the answer must be a pure function of its arguments. Chance is keyed by
/// the bits of the ray, which no other ray of the picture shares; the path would serve as well, but has an ID only in
/// shading. Any thread may call.
class AnyHit {
 public:
  virtual ~AnyHit() = default;

  /// `ray` in world space; `u` and `v` as in Hit.
  virtual bool accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const = 0;
};

/// An any-hit call: the ray, and the place in front of its closest hit so far at which it met the primitive.
struct AnyHitCall {
  const RayRecord* record;
  Hit place;
};

}  // namespace carousel

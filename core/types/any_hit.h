#pragma once

#include <cstdint>

#include "core/types/ray.h"

namespace carousel {

/// Whether a ray stops where it crosses a primitive that may let it through: a cut-out, or a veil that stops rays by
/// chance. Asked by the ray's owner, wherever the ray happens to be tested, and perhaps more than once or not at all,
/// since nearer hits may have settled the matter: so the answer must be a pure function of its arguments. Chance is
/// keyed by the bits of the ray, which no other ray of the frame shares (DESIGN.md section 3 keys it by the path, which
/// has an ID but in shading). Any thread may call.
class AnyHit {
 public:
  virtual ~AnyHit() = default;

  /// `ray` in world space; `u` and `v` as in Hit.
  virtual bool accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const = 0;
};

}  // namespace carousel

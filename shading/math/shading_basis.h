#pragma once

#include <cmath>

#include <glm/geometric.hpp>

#include "core/types/vec.h"

namespace carousel::shading {

/// Orthonormal directions around a unit normal; local z is the normal.
struct ShadingBasis {
  Vec3 tangent, bitangent, normal;

  /// T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6(1), 2017.
  explicit ShadingBasis(const Vec3& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  /// `t` is unit and at right angles to `n`.
  ShadingBasis(const Vec3& n, const Vec3& t) : tangent(t), bitangent(glm::cross(n, t)), normal(n) {}

  Vec3 to_local(const Vec3& v) const { return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)}; }
  Vec3 to_world(const Vec3& v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

}  // namespace carousel::shading

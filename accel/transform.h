#pragma once

#include "core/aabb.h"
#include "core/ray.h"
#include "core/vec.h"
#include "scene/scene.h"

namespace carousel::accel {

/// World to model space in two steps (US 12394134): subtract the translation, then apply the inverse linear
/// part. Cancellation happens in the subtraction, where it is exact or nearly so, and not after a product with
/// a large matrix entry has been rounded. The direction is not renormalised, so t means the same in both.
struct InstanceTransform {
  Mat3 inverse_linear{1.0f};   ///< computed in double, rounded once
  Vec3 translation{0};
  bool identity = true;        ///< no arithmetic at all

  [[gnu::always_inline]] Ray to_model(const Ray& world) const {
    if (identity) return world;
    Ray model = world;
    const Vec3 p{world.origin.x - translation.x, world.origin.y - translation.y, world.origin.z - translation.z};
    for (int row = 0; row < 3; ++row) {
      model.origin[row] = inverse_linear[0][row] * p.x + inverse_linear[1][row] * p.y + inverse_linear[2][row] * p.z;
      model.direction[row] = inverse_linear[0][row] * world.direction.x +
                             inverse_linear[1][row] * world.direction.y +
                             inverse_linear[2][row] * world.direction.z;
    }
    return model;
  }
};

/// False when the linear part has no usable inverse in float: the instance must then be baked into world space.
bool make_transform(const scene::Affine& world_from_model, InstanceTransform& out);

/// A world box that holds every model point of `model`, whatever rounding the transform of a ray commits:
/// corners in double, padded by gamma(4) (sum |R x| + |T|) and one nextafter outwards (DESIGN.md section 5).
Aabb world_box(const scene::Affine& world_from_model, const Aabb& model);

}  // namespace carousel::accel

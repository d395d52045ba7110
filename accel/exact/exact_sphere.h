#pragma once

#include <array>
#include <optional>

#include "accel/exact/exact_crossing.h"
#include "accel/exact/exact_root.h"
#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The crossings of a ray's line with a sphere that is placed by R x + T, an ellipsoid, without rounding.
struct ExactSphereCrossings {
  std::array<ExactRoot, 2> t;  ///< where the line enters and where it leaves; equal where it touches

  /// The outward unit normal at one of them, in model space: each coordinate is off by a rounding of double or two.
  DVec3 normal(std::size_t k) const;

  // In model space times the determinant of R, seen from the centre: where the ray starts, and its direction.
  DyadicVec from, along;
  Dyadic radius;  ///< times the determinant
};

/// Every float is taken as the real number that it stands for. Empty if the line passes by; a line that touches does
/// not. Empty as well if R is singular.
std::optional<ExactSphereCrossings> exact_sphere(const Ray& ray, const scene::Sphere& sphere,
                                                 const scene::Affine& world_from_model);

}  // namespace carousel::accel

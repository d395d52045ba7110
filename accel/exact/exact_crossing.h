#pragma once

#include <array>
#include <optional>

#include "accel/exact/dyadic.h"
#include "accel/exact/exact_matrix.h"
#include "core/types/ray.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The crossing of a ray's line with a triangle, without rounding: t = numerator / denominator with denominator > 0;
/// the vertices' weights are weight[k] / denominator.
struct ExactCrossing {
  Dyadic numerator, denominator;
  std::array<Dyadic, 3> weight;
  bool front = false;  ///< the ray sees the vertices, as they stand in the world, counter-clockwise

  /// Sign of t - x.
  int compare(double x) const { return (numerator - Dyadic(x) * denominator).sign(); }
  /// Sign of t - other.t.
  int compare(const ExactCrossing& other) const {
    return (numerator * other.denominator - other.numerator * denominator).sign();
  }
};

/// The crossing with the triangle `model` placed by R x + T, taken as the reals that the floats stand for. Edges and
/// vertices belong to the triangle. Empty if the line passes by or lies in the plane, or if the triangle has no area.
std::optional<ExactCrossing> exact_crossing(const Ray& ray, const std::array<Vec3, 3>& model,
                                            const scene::Affine& world_from_model);

}  // namespace carousel::accel

#pragma once

#include <algorithm>
#include <optional>

#include "accel/transform/transform.h"
#include "core/types/aabb.h"
#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The margin by which planes and boxes are moved outwards: Node::margin_per_reach and least_margin.
struct LineMargin {
  float per_reach = 0, least = 0;
};

/// Raises each to the other's.
inline void widen(LineMargin& margin, const LineMargin& other) {
  margin = {std::max(margin.per_reach, other.per_reach), std::max(margin.least, other.least)};
}

/// The magnitude of every entry of a matrix.
DMat3 magnitudes(const DMat3& m);

/// Below the instances, where the line is that of the ray the kernel gets.
LineMargin margin_below();

/// The margin in the world for one instance, whose triangles are hit by the ray that `transform`, of an instance placed
/// by `world_from_model`, has rounded. `model` holds the instance's vertices. Empty if no useful bound is known,
/// because the matrix is nearly singular or its entries are too large or small. Not for inverse_matrix.
std::optional<LineMargin> margin_in_world(const scene::Affine& world_from_model, const InstanceTransform& transform,
                                          const Aabb& model);

}  // namespace carousel::accel

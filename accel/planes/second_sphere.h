#pragma once

#include <optional>
#include <vector>

#include "accel/structure/cull_plane.h"
#include "accel/structure/sphere.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// A small sphere around points and spheres that stand in `box`, as a CullPlane whose normal is its centre and whose
/// distance its radius, rounded up; none if it cuts hardly any of the box off.
std::optional<CullPlane> second_sphere(const std::vector<Vec3>& points, const std::vector<BlockSphere>& spheres,
                                       const Aabb& box);

}  // namespace carousel::accel

#pragma once

#include <cstdint>

#include "accel/structure/node.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// Spheres around what stands below the lanes of a node, instead of its boxes (`bvh.elements: spheres`).
struct alignas(64) NodeSpheres {
  float centre[3][kMaxWidth];
  float radius[kMaxWidth];
};
static_assert(sizeof(NodeSpheres) == 128);

/// Bit l when the ray may meet something below lane l before `tmax`; entries of these lanes are stored, not below tmin,
/// and no hit below is nearer.
///
/// A hit is no nearer than where the slab test enters the primitive's box (docs/how-it-works/design.md, What a hit is),
/// which it passes by no more than the 16 u of the distance that its far side is moved out by, and the rounding of near
/// planes: 2^-19 of what lies between the origin and the box's far end along each axis. So a sphere around the box, its
/// radius moved out by 2^-18 of the way to its own far side, is met by the exact line, and entered no later. The
/// arithmetic is double, whose rounding is nothing beside that. `direction` may have any length. Any thread.
std::uint32_t intersect_spheres(const NodeSpheres& spheres, int count, const Vec3& origin, const Vec3& direction,
                                float tmin, float tmax, float* entry);

}  // namespace carousel::accel

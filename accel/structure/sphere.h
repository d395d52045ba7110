#pragma once

#include "accel/structure/node.h"
#include "core/types/aabb.h"
#include "core/types/vec.h"

namespace carousel::accel {

/// The crossings of a ray's line with a sphere, in double: t and the outward unit normal at the entry and at the exit.
struct SphereCrossing {
  double t[2];
  DVec3 normal[2];
};

/// True if the line of the ray (both ways, its range ignored) crosses the sphere. The discriminant is computed from the
/// distance of the centre from the line, and the nearer root without a difference of like numbers (Haines et al.,
/// "Precision improvements for ray/sphere intersection", Ray Tracing Gems 2019, chapter 7). In double the rounding
/// errors are far below that of the resulting float t. The test is the same at all levels of accuracy. False for a
/// radius or direction of zero, and for anything with a NaN.
bool cross_sphere(const Vec3& origin, const Vec3& direction, const Vec3& centre, float radius, SphereCrossing& out);

/// A sphere where it stands in a block of a procedural leaf.
struct BlockSphere {
  Vec3 centre;
  float radius;
};
inline BlockSphere sphere_in(const TriangleBlock& block, std::size_t lane) {
  return {{block.vertex[0][0][lane], block.vertex[0][1][lane], block.vertex[0][2][lane]}, block.vertex[1][0][lane]};
}

/// The smallest box of floats that holds the sphere.
Aabb sphere_box(const Vec3& centre, float radius);

}  // namespace carousel::accel

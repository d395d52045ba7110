#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

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

/// A sphere where it stands in a block of a procedural leaf; or the sphere around a primitive with a program.
struct BlockSphere {
  Vec3 centre;
  float radius;
};
inline BlockSphere sphere_in(const TriangleBlock& block, std::size_t lane) {
  return {{block.vertex[0][0][lane], block.vertex[0][1][lane], block.vertex[0][2][lane]}, block.vertex[1][0][lane]};
}

/// The program of the primitive in a lane, a number in Accel::programs; scene::kNoProgram for a sphere.
inline std::uint32_t program_in(const TriangleBlock& block, std::size_t lane) {
  return std::bit_cast<std::uint32_t>(block.vertex[1][1][lane]);
}

/// The smallest box of floats that reaches so far from its middle.
Aabb box_around(const Vec3& centre, const Vec3& reach);
/// The smallest box of floats that holds the sphere.
inline Aabb sphere_box(const Vec3& centre, float radius) {
  return box_around(centre, Vec3(radius));
}

/// The box of a procedural primitive of either kind, where it stands in a block.
inline Aabb procedural_box(const TriangleBlock& block, std::size_t lane) {
  const auto& reach = block.vertex[2];
  return box_around(sphere_in(block, lane).centre, {reach[0][lane], reach[1][lane], reach[2][lane]});
}

}  // namespace carousel::accel

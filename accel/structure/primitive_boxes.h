#pragma once

#include <vector>

#include "accel/structure/accel.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

/// The vertices of a leaf's triangle number `i`.
inline std::array<Vec3, 3> triangle_corners(const Accel& accel, NodeRef leaf, std::uint32_t i) {
  const auto& v = accel.blocks[leaf.first_block() + i / kBlockTriangles].vertex;
  const std::size_t lane = i % kBlockTriangles;
  return {Vec3{v[0][0][lane], v[0][1][lane], v[0][2][lane]}, Vec3{v[1][0][lane], v[1][1][lane], v[1][2][lane]},
          Vec3{v[2][0][lane], v[2][1][lane], v[2][2][lane]}};
}

/// The box of a leaf's primitive number `i`.
inline Aabb primitive_box(const Accel& accel, NodeRef leaf, std::uint32_t i) {
  if (leaf.is_procedural())
    return procedural_box(accel.blocks[leaf.first_block() + i / kBlockTriangles], i % kBlockTriangles);
  Aabb box;
  for (const Vec3& corner : triangle_corners(accel, leaf, i)) box.extend(corner);
  return box;
}

}  // namespace carousel::accel

#include "accel/builders/mesh/primitive_blocks.h"

#include <bit>

#include "accel/structure/sphere.h"

namespace carousel::accel {

BuildPrimitives primitive_boxes(const BlasMeshes& meshes, Executor& executor, const MeshPiece* piece) {
  const std::size_t triangles = meshes.triangles();
  BuildPrimitives out(piece != nullptr ? piece->size() : meshes.size());
  executor.parallel_for(out.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      const std::size_t i = piece != nullptr ? (*piece)[at] : at;
      Aabb box;
      if (i < triangles) {
        const auto [mesh, index] = meshes.triangle(static_cast<std::uint32_t>(i));
        for (std::size_t k = 0; k < 3; ++k) box.extend(mesh->positions[mesh->indices[3 * std::size_t{index} + k]]);
      } else {
        const scene::Sphere& sphere = meshes.front().spheres[i - triangles];
        box = box_around(sphere.center, sphere.reach());
      }
      out[at].lo = box.lo;
      out[at].hi = box.hi;
      out[at].index = static_cast<std::uint32_t>(i);
    }
  });
  return out;
}

bool fill_block(const BlasMeshes& meshes, const scene::Opacity& opacity, const std::uint32_t* primitives,
                std::uint32_t count, TriangleBlock& block) {
  bool some = false;
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    const std::uint32_t number = primitives[lane];
    const auto set = [&](std::size_t vertex, const Vec3& p) {
      for (int axis = 0; axis < 3; ++axis) block.vertex[vertex][axis][lane] = p[axis];
    };
    bool calls_any_hit;
    if (number >= meshes.triangles()) {
      const scene::Sphere& sphere = meshes.front().spheres[number - meshes.triangles()];
      set(0, sphere.center);
      block.vertex[1][0][lane] = sphere.radius;
      block.vertex[1][1][lane] = std::bit_cast<float>(sphere.program);
      set(2, sphere.reach());
      calls_any_hit = opacity.may_be_non_opaque(sphere);
    } else {
      const auto [mesh, index] = meshes.triangle(number);
      for (std::size_t k = 0; k < 3; ++k) set(k, mesh->positions[mesh->indices[3 * std::size_t{index} + k]]);
      calls_any_hit = opacity.may_be_non_opaque(*mesh, index);
    }
    block.primitive[lane] = number | (calls_any_hit ? kNonOpaqueBit : 0);
    some |= calls_any_hit;
  }
  return some;
}

}  // namespace carousel::accel

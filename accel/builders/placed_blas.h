#pragma once

#include <cstdint>

#include "accel/builders/mesh/blas.h"

namespace carousel::accel {

/// The structure over a mesh or a piece of one, and where its arrays start in the joint ones.
struct PlacedBlas {
  std::uint32_t source = 0;  ///< number of the mesh
  MeshPiece piece;           ///< empty: all of it
  Blas blas;
  std::uint32_t nodes = 0, blocks = 0;  ///< also where it is at another rank
  std::uint32_t first_node = 0, first_block = 0;

  NodeRef place(NodeRef ref) const {
    if (ref.is_inner()) return NodeRef::inner(ref.node() + first_node);
    const std::uint32_t block = ref.first_block() + first_block;
    return ref.is_procedural() ? NodeRef::procedural(block, ref.triangles()) : NodeRef::leaf(block, ref.triangles());
  }
};

/// The structure over a whole mesh, of one BLAS or of several with nodes above them.
struct PlacedMesh {
  WideTree tree;  ///< meaningless when the mesh is empty
  Aabb box;
};

/// The mesh as its instance stands in the world, for transforms that have no inverse.
inline scene::Mesh bake(const scene::Mesh& mesh, const scene::Affine& m) {
  scene::Mesh out;
  out.indices = mesh.indices;
  out.triangle_materials = mesh.triangle_materials;
  out.colors = mesh.colors;
  out.positions.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) out.positions.push_back(m.linear * p + m.translation);
  return out;
}

}  // namespace carousel::accel

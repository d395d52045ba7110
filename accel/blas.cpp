#include "accel/blas.h"

#include "accel/sah_build.h"

namespace carousel::accel {

namespace {

std::vector<BuildPrimitive> triangle_boxes(const scene::Mesh& mesh, Executor& executor) {
  std::vector<BuildPrimitive> out(mesh.triangle_count());
  executor.parallel_for(out.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Aabb box;
      for (int k = 0; k < 3; ++k) box.extend(mesh.positions[mesh.indices[3 * i + k]]);
      out[i].lo = box.lo;
      out[i].hi = box.hi;
      out[i].index = static_cast<std::uint32_t>(i);
    }
  });
  return out;
}

void fill_block(const scene::Mesh& mesh, const BuildPrimitive* primitives, std::uint32_t count,
                TriangleBlock& block) {
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    const std::uint32_t triangle = primitives[lane].index;
    block.primitive[lane] = triangle;
    for (int k = 0; k < 3; ++k) {
      const Vec3& p = mesh.positions[mesh.indices[3 * std::size_t{triangle} + k]];
      for (int axis = 0; axis < 3; ++axis) block.vertex[k][axis][lane] = p[axis];
    }
  }
}

}  // namespace

Blas build_blas(const scene::Mesh& mesh, const BvhConfig& config, Executor& executor) {
  Blas blas;
  std::vector<BuildPrimitive> primitives = triangle_boxes(mesh, executor);
  if (primitives.empty()) return blas;
  SahSettings settings;
  settings.leaf_primitives = static_cast<std::uint32_t>(config.leaf_triangles);
  settings.block_primitives = std::min<std::uint32_t>(kBlockTriangles, settings.leaf_primitives);
  const std::vector<BinaryNode> binary = build_sah(primitives, settings, executor);
  blas.box = binary[0].box;

  struct Fill {
    std::uint32_t first, count;
  };
  std::vector<Fill> fills;   // one a block
  fills.reserve(primitives.size() / 2);
  const auto make_leaf = [&](const BinaryNode& leaf) {
    const std::uint32_t first_block = static_cast<std::uint32_t>(fills.size());
    for (std::uint32_t i = 0; i < leaf.count; i += kBlockTriangles)
      fills.push_back({leaf.first + i, std::min<std::uint32_t>(kBlockTriangles, leaf.count - i)});
    return WideLeaf{NodeRef::leaf(first_block, leaf.count), static_cast<std::uint8_t>(leaf.count), leaf.count};
  };
  blas.nodes.reserve(primitives.size() / 8 + 1);
  blas.tree = collapse(binary, static_cast<int>(config.width), make_leaf, blas.nodes);
  blas.nodes.shrink_to_fit();
  blas.blocks.resize(fills.size());
  executor.parallel_for(fills.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fill_block(mesh, primitives.data() + fills[i].first, fills[i].count, blas.blocks[i]);
  });
  return blas;
}

}  // namespace carousel::accel

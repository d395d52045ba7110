#include "accel/build/blas.h"

#include <algorithm>
#include <utility>

#include "accel/build/binary/reference_build.h"
#include "accel/build/binary/reinsertion.h"
#include "accel/build/binary/sah_build.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

/// Triangles, then spheres, with their boxes.
std::vector<BuildPrimitive> boxes(const BlasMeshes& meshes, const MeshPiece* piece, Executor& executor) {
  const std::size_t triangles = meshes.triangles();
  std::vector<BuildPrimitive> out(piece != nullptr ? piece->size() : meshes.size());
  executor.parallel_for(out.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; ++at) {
      const std::size_t i = piece != nullptr ? (*piece)[at] : at;
      Aabb box;
      if (i < triangles) {
        const auto [mesh, index] = meshes.triangle(static_cast<std::uint32_t>(i));
        for (std::size_t k = 0; k < 3; ++k) box.extend(mesh->positions[mesh->indices[3 * std::size_t{index} + k]]);
      } else {
        const scene::Sphere& sphere = meshes.front().spheres[i - triangles];
        box = sphere_box(sphere.center, sphere.radius);
      }
      out[at].lo = box.lo;
      out[at].hi = box.hi;
      out[at].index = static_cast<std::uint32_t>(i);
    }
  });
  return out;
}

void fill_block(const BlasMeshes& meshes, const scene::Opacity& opacity, const BuildPrimitive* primitives,
                std::uint32_t count, TriangleBlock& block) {
  for (std::uint32_t lane = 0; lane < count; ++lane) {
    const std::uint32_t number = primitives[lane].index;
    const auto set = [&](std::size_t vertex, const Vec3& p) {
      for (int axis = 0; axis < 3; ++axis) block.vertex[vertex][axis][lane] = p[axis];
    };
    bool calls_any_hit;
    if (number >= meshes.triangles()) {
      const scene::Sphere& sphere = meshes.front().spheres[number - meshes.triangles()];
      set(0, sphere.center);
      block.vertex[1][0][lane] = sphere.radius;
      calls_any_hit = opacity.may_be_non_opaque(sphere);
    } else {
      const auto [mesh, index] = meshes.triangle(number);
      for (std::size_t k = 0; k < 3; ++k) set(k, mesh->positions[mesh->indices[3 * std::size_t{index} + k]]);
      calls_any_hit = opacity.may_be_non_opaque(*mesh, index);
    }
    block.primitive[lane] = number | (calls_any_hit ? kNonOpaqueBit : 0);
  }
}

std::vector<BinaryNode> build_tree(std::vector<BuildPrimitive>& primitives, const BvhConfig& config,
                                   const SahSettings& settings, Executor& executor) {
  return config.builder == BvhConfig::Builder::kSah
             ? build_sah(primitives, settings, executor)
             : build_references(primitives, settings, config.builder, config.duplicates);
}

/// One tree over triangles and spheres, whose leaves hold either the ones or the others.
std::vector<BinaryNode> build_both(std::vector<BuildPrimitive>& primitives, std::size_t triangles,
                                   const BvhConfig& config, const SahSettings& settings, Executor& executor) {
  if (triangles == 0 || triangles == primitives.size()) return build_tree(primitives, config, settings, executor);
  std::vector<BinaryNode> joint(1);
  const auto middle = primitives.begin() + static_cast<std::ptrdiff_t>(triangles);
  std::vector<BuildPrimitive> parts[2] = {{primitives.begin(), middle}, {middle, primitives.end()}};
  primitives.clear();
  for (std::vector<BuildPrimitive>& part : parts) {
    const std::uint32_t at = static_cast<std::uint32_t>(joint.size());
    const std::uint32_t first = static_cast<std::uint32_t>(primitives.size());
    (primitives.empty() ? joint[0].first : joint[0].right) = at;
    for (BinaryNode node : build_tree(part, config, settings, executor)) {
      node.first += node.count == 0 ? at : first;
      node.right += at;
      joint.push_back(node);
    }
    primitives.insert(primitives.end(), part.begin(), part.end());
    joint[0].box.extend(joint[at].box);
  }
  return joint;
}

}  // namespace

Blas build_blas(const BlasMeshes& meshes, const scene::Opacity& opacity, const BvhConfig& config, Executor& executor,
                const MeshPiece* piece) {
  Blas blas;
  std::vector<BuildPrimitive> primitives = boxes(meshes, piece, executor);
  if (primitives.empty()) return blas;
  const auto first_sphere = std::find_if(primitives.begin(), primitives.end(),
                                         [&](const BuildPrimitive& p) { return p.index >= meshes.triangles(); });
  const auto triangles = static_cast<std::size_t>(first_sphere - primitives.begin());
  SahSettings settings;
  settings.leaf_primitives = static_cast<std::uint32_t>(config.leaf_triangles);
  settings.block_primitives = std::min<std::uint32_t>(kBlockTriangles, settings.leaf_primitives);
  std::vector<BinaryNode> binary = build_both(primitives, triangles, config, settings, executor);
  if (config.quality == BvhConfig::Quality::kHigh) reinsert(binary, executor);
  blas.box = binary[0].box;

  struct Fill {
    std::uint32_t first, count;
  };
  std::vector<Fill> fills;  // one a block
  fills.reserve(primitives.size() / 2);
  const auto make_leaf = [&](const BinaryNode& leaf) {
    const std::uint32_t first_block = static_cast<std::uint32_t>(fills.size());
    for (std::uint32_t i = 0; i < leaf.count; i += kBlockTriangles)
      fills.push_back({leaf.first + i, std::min<std::uint32_t>(kBlockTriangles, leaf.count - i)});
    const bool procedural = primitives[leaf.first].index >= meshes.triangles();
    return WideLeaf{procedural ? NodeRef::procedural(first_block, leaf.count) : NodeRef::leaf(first_block, leaf.count),
                    static_cast<std::uint8_t>(leaf.count), leaf.count};
  };
  blas.nodes.reserve(primitives.size() / 8 + 1);
  blas.tree = collapse(binary, static_cast<int>(config.width), make_leaf, blas.nodes);
  blas.nodes.shrink_to_fit();
  blas.blocks.resize(fills.size());
  executor.parallel_for(fills.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      fill_block(meshes, opacity, primitives.data() + fills[i].first, fills[i].count, blas.blocks[i]);
  });
  for (const TriangleBlock& block : blas.blocks)
    for (const std::uint32_t primitive : block.primitive)
      blas.has_non_opaque |= primitive != kNoPrimitive && (primitive & kNonOpaqueBit) != 0;
  return blas;
}

}  // namespace carousel::accel

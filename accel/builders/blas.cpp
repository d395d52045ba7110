#include "accel/builders/blas.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "accel/builders/binary/reference_build.h"
#include "accel/builders/binary/reinsertion.h"
#include "accel/builders/binary/sah_build.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

/// Triangles, then spheres, with their boxes.
BuildPrimitives boxes(const BlasMeshes& meshes, const MeshPiece* piece, Executor& executor) {
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
        box = sphere_box(sphere.center, sphere.radius);
      }
      out[at].lo = box.lo;
      out[at].hi = box.hi;
      out[at].index = static_cast<std::uint32_t>(i);
    }
  });
  return out;
}

/// Their numbers; the primitives' memory is given back, since what is built next needs as much.
std::vector<std::uint32_t> order_of(BuildPrimitives primitives, Executor& executor) {
  std::vector<std::uint32_t> order(primitives.size());
  executor.parallel_for(order.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) order[i] = primitives[i].index;
  });
  return order;
}

/// True if some of the primitives may be non-opaque.
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

BinaryTree build_tree(BuildPrimitives& primitives, const BvhConfig& config, const SahSettings& settings,
                      Executor& executor) {
  return config.builder == BvhConfig::Builder::kSah
             ? build_sah(primitives, settings, executor)
             : build_references(primitives, settings, config.builder, config.duplicates);
}

/// Appends a tree, over primitives of which the first has the place `first` now.
void append(const BinaryTree& tree, std::uint32_t first, BinaryTree& out) {
  const auto at = static_cast<std::uint32_t>(out.size());
  out.resize(at + tree.size());
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t place = open.back();
    open.pop_back();
    BinaryNode node = tree[place];
    if (node.count == 0) open.insert(open.end(), {node.first, node.right});
    node.first += node.count == 0 ? at : first;
    node.right += at;
    out[at + place] = node;
  }
}

/// One tree over triangles and spheres, whose leaves hold either the ones or the others.
BinaryTree build_both(BuildPrimitives& primitives, std::size_t triangles, const BvhConfig& config,
                      const SahSettings& settings, Executor& executor) {
  if (triangles == 0 || triangles == primitives.size()) return build_tree(primitives, config, settings, executor);
  BinaryTree joint(1, BinaryNode{});
  const auto middle = primitives.begin() + static_cast<std::ptrdiff_t>(triangles);
  BuildPrimitives parts[2] = {{primitives.begin(), middle}, {middle, primitives.end()}};
  primitives.clear();
  for (BuildPrimitives& part : parts) {
    const std::uint32_t at = static_cast<std::uint32_t>(joint.size());
    const std::uint32_t first = static_cast<std::uint32_t>(primitives.size());
    (primitives.empty() ? joint[0].first : joint[0].right) = at;
    append(build_tree(part, config, settings, executor), first, joint);
    primitives.insert(primitives.end(), part.begin(), part.end());
    joint[0].box.extend(joint[at].box);
  }
  return joint;
}

}  // namespace

Blas build_blas(const BlasMeshes& meshes, const scene::Opacity& opacity, const BvhConfig& config, Executor& executor,
                const MeshPiece* piece) {
  Blas blas;
  BuildPrimitives primitives = boxes(meshes, piece, executor);
  if (primitives.empty()) return blas;
  const auto first_sphere = std::find_if(primitives.begin(), primitives.end(),
                                         [&](const BuildPrimitive& p) { return p.index >= meshes.triangles(); });
  const auto triangles = static_cast<std::size_t>(first_sphere - primitives.begin());
  SahSettings settings;
  settings.leaf_primitives = static_cast<std::uint32_t>(config.leaf_triangles);
  settings.block_primitives = std::min<std::uint32_t>(kBlockTriangles, settings.leaf_primitives);
  BinaryTree binary = build_both(primitives, triangles, config, settings, executor);
  if (config.quality == BvhConfig::Quality::kHigh) reinsert(binary, executor);
  blas.box = binary[0].box;

  const std::vector<std::uint32_t> order = order_of(std::move(primitives), executor);
  const auto make_leaf = [&](const BinaryNode& leaf, std::uint32_t first_block) {
    const bool procedural = order[leaf.first] >= meshes.triangles();
    return WideLeaf{procedural ? NodeRef::procedural(first_block, leaf.count) : NodeRef::leaf(first_block, leaf.count),
                    static_cast<std::uint8_t>(leaf.count), leaf.count};
  };
  std::vector<BlockRun> runs;
  blas.tree = collapse(binary, static_cast<int>(config.width), make_leaf, executor, blas.nodes, &runs);
  BinaryTree().swap(binary);  // before blocks take memory
  std::size_t blocks = 0;
  for (const BlockRun& run : runs) blocks += run.blocks.size();
  blas.blocks.grow(blocks);
  std::atomic<bool> has_non_opaque = false;
  executor.parallel_for(runs.size(), 1, [&](std::size_t begin, std::size_t end) {
    bool some = false;
    for (std::size_t i = begin; i < end; ++i) {
      TriangleBlock* out = blas.blocks.data() + runs[i].first_block;
      for (const BlockPrimitives& of : runs[i].blocks) {
        TriangleBlock block;
        some |= fill_block(meshes, opacity, order.data() + of.first, of.count, block);
        *out++ = block;
      }
    }
    if (some) has_non_opaque = true;
  });
  blas.has_non_opaque = has_non_opaque;
  return blas;
}

}  // namespace carousel::accel

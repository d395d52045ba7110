#include "accel/builders/mesh/blas.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "accel/builders/binary/reference_build.h"
#include "accel/builders/binary/reinsertion.h"
#include "accel/builders/binary/sah_build.h"
#include "accel/builders/mesh/primitive_blocks.h"

namespace carousel::accel {

namespace {

/// Their numbers; the primitives' memory is given back, since what is built next needs as much.
std::vector<std::uint32_t> order_of(BuildPrimitives primitives, Executor& executor) {
  std::vector<std::uint32_t> order(primitives.size());
  executor.parallel_for(order.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) order[i] = primitives[i].index;
  });
  return order;
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
  BuildPrimitives primitives = primitive_boxes(meshes, executor, piece);
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

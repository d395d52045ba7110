#include "accel/builders/rank_shares.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <type_traits>
#include <utility>

#include "accel/builders/binary/sah_build.h"

namespace carousel::accel {

namespace {

/// The facts of a piece's structure that ranks without it need for the nodes above it.
struct Summary {
  std::uint32_t piece = 0, nodes = 0, blocks = 0;
  std::uint32_t has_non_opaque = 0;
  WideTree tree;
  Aabb box;
};
static_assert(std::is_trivially_copyable_v<Summary>);

}  // namespace

std::vector<std::uint32_t> share_meshes(std::span<const std::uint64_t> sizes, std::uint32_t ranks) {
  std::vector<std::uint32_t> order(sizes.size()), home(sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return sizes[a] > sizes[b]; });
  std::vector<std::uint64_t> load(ranks);
  for (const std::uint32_t mesh : order) {
    const auto least = std::min_element(load.begin(), load.end());
    *least += sizes[mesh];
    home[mesh] = static_cast<std::uint32_t>(least - load.begin());
  }
  return home;
}

void share_out(std::span<const BlasMeshes> meshes, const BuildRanks& ranks, std::vector<PlacedBlas>& pieces,
               std::vector<std::uint32_t>& home) {
  constexpr std::uint64_t kLeast = 64, kPieces = 8;
  std::uint64_t all = 0;
  for (const BlasMeshes& mesh : meshes) all += mesh.size();
  const std::uint64_t most = std::max(kLeast, all / (kPieces * ranks.ranks));
  std::vector<std::uint64_t> sizes;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    if (meshes[i].size() <= most) {
      pieces.emplace_back().source = i;
      sizes.push_back(meshes[i].size());
      continue;
    }
    for (MeshPiece& piece : divide_mesh(meshes[i].front(), most)) {
      sizes.push_back(piece.size());
      PlacedBlas& placed = pieces.emplace_back();
      placed.source = i;
      placed.piece = std::move(piece);
    }
  }
  home = share_meshes(sizes, ranks.ranks);
}

PlacedMesh join_at_top(std::span<const PlacedBlas> pieces, int width, Executor& executor, NodeArray& nodes) {
  BuildPrimitives primitives;
  PlacedMesh out;
  int depth = 0;
  for (const PlacedBlas& piece : pieces) {
    BuildPrimitive& p = primitives.emplace_back();
    p.lo = piece.blas.box.lo;
    p.hi = piece.blas.box.hi;
    p.index = static_cast<std::uint32_t>(&piece - pieces.data());
    out.box.extend(piece.blas.box);
    depth = std::max(depth, piece.blas.tree.depth);
  }
  const BinaryTree binary = build_sah(primitives, {.leaf_primitives = 1, .block_primitives = 1}, executor);
  const auto make_leaf = [&](const BinaryNode& leaf, std::uint32_t) {
    const PlacedBlas& piece = pieces[primitives[leaf.first].index];
    const WideTree& tree = piece.blas.tree;
    return WideLeaf{piece.place(tree.root), tree.root_strip_size, tree.triangles};
  };
  out.tree = collapse(binary, width, make_leaf, executor, nodes);
  out.tree.depth += depth;
  return out;
}

void exchange_summaries(const BuildRanks& ranks, std::span<const std::uint32_t> home, std::span<PlacedBlas> blases) {
  std::vector<Summary> own;
  for (std::uint32_t i = 0; i < blases.size(); ++i)
    if (home[i] == ranks.rank)
      own.push_back({i, blases[i].nodes, blases[i].blocks, blases[i].blas.has_non_opaque, blases[i].blas.tree,
                     blases[i].blas.box});
  const std::string told(reinterpret_cast<const char*>(own.data()), own.size() * sizeof(Summary));
  for (const std::string& bytes : ranks.gather(told)) {
    for (std::size_t at = 0; at + sizeof(Summary) <= bytes.size(); at += sizeof(Summary)) {
      Summary other;
      std::memcpy(static_cast<void*>(&other), bytes.data() + at, sizeof other);
      if (home[other.piece] == ranks.rank) continue;
      PlacedBlas& placed = blases[other.piece];
      placed.nodes = other.nodes;
      placed.blocks = other.blocks;
      placed.blas.has_non_opaque = other.has_non_opaque != 0;
      placed.blas.tree = other.tree;
      placed.blas.box = other.box;
    }
  }
}

Partition partition_of(std::uint32_t rank, std::span<const std::uint64_t> nodes,
                       std::span<const std::uint64_t> blocks) {
  Partition out{rank, {0}, {0}, 0};
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    out.node_begin.push_back(static_cast<std::uint32_t>(out.node_begin.back() + nodes[r]));
    out.block_begin.push_back(static_cast<std::uint32_t>(out.block_begin.back() + blocks[r]));
  }
  return out;
}

}  // namespace carousel::accel

#include "accel/build/rank_shares.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <type_traits>

namespace carousel::accel {

namespace {

/// What other ranks have to know of a structure that they do not have.
struct Summary {
  std::uint32_t mesh = 0, nodes = 0, blocks = 0;
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
      if (home[other.mesh] == ranks.rank) continue;
      PlacedBlas& placed = blases[other.mesh];
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
  Partition out{rank, {0}, {0}};
  for (std::size_t r = 0; r < nodes.size(); ++r) {
    out.node_begin.push_back(static_cast<std::uint32_t>(out.node_begin.back() + nodes[r]));
    out.block_begin.push_back(static_cast<std::uint32_t>(out.block_begin.back() + blocks[r]));
  }
  return out;
}

}  // namespace carousel::accel

#include "accel/structure/guest_shapes.h"

#include <bit>
#include <cstring>
#include <limits>

#include "accel/structure/accel.h"
#include "core/system/error.h"
#include "core/system/sparse_memory.h"

namespace carousel::accel {

namespace {

constexpr std::size_t kNodeWords = sizeof(Node) / sizeof(std::uint64_t);
constexpr std::size_t kBlockWords = sizeof(TriangleBlock) / sizeof(std::uint64_t);

/// The first two words of a packing.
struct Header {
  std::uint32_t nodes = 0, blocks = 0;
  std::uint32_t first = 0;    // bits of the NodeRef, by number within the packing
  std::uint32_t subtree = 0;  // not 0: all that is below the first
};
static_assert(sizeof(Header) == 2 * sizeof(std::uint64_t));

NodeRef moved(NodeRef ref, std::uint32_t node, std::uint32_t block) {
  if (ref.is_inner()) return NodeRef::inner(node);
  return ref.is_procedural() ? NodeRef::procedural(block, ref.triangles()) : NodeRef::leaf(block, ref.triangles());
}

/// Bits of the lanes of a node whose children are in its packing.
std::uint32_t packed_lanes(const Node& node, bool subtree) {
  return subtree ? (1u << node.count) - 1 : node.direct;
}

class Packing {
 public:
  Packing(const Accel& accel, bool subtree) : accel_(accel), subtree_(subtree) {}

  NodeRef add(NodeRef ref) {
    if (!ref.is_inner()) {
      const auto at = static_cast<std::uint32_t>(blocks_.size());
      for (std::uint32_t b = 0; b < ref.blocks(); ++b) blocks_.push_back(ref.first_block() + b);
      return moved(ref, 0, at);
    }
    const std::size_t at = nodes_.size();
    nodes_.push_back(accel_.nodes[ref.node()]);
    for (std::uint32_t left = packed_lanes(nodes_[at], subtree_); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const NodeRef child = add(nodes_[at].child[lane]);
      nodes_[at].child[lane] = child;
    }
    return NodeRef::inner(static_cast<std::uint32_t>(at));
  }

  void write(NodeRef first, std::vector<std::uint64_t>& words) const {
    const Header header{static_cast<std::uint32_t>(nodes_.size()), static_cast<std::uint32_t>(blocks_.size()),
                        first.bits(), std::uint32_t{subtree_}};
    std::size_t at = words.size();
    words.resize(at + 2 + nodes_.size() * kNodeWords + blocks_.size() * kBlockWords);
    const auto put = [&](const void* data, std::size_t bytes) {
      std::memcpy(words.data() + at, data, bytes);
      at += bytes / sizeof(std::uint64_t);
    };
    put(&header, sizeof header);
    if (!nodes_.empty()) put(nodes_.data(), nodes_.size() * sizeof(Node));
    for (const std::uint32_t block : blocks_) put(&accel_.blocks[block], sizeof(TriangleBlock));
  }

 private:
  const Accel& accel_;
  bool subtree_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> blocks_;
};

}  // namespace

GuestShapes::GuestShapes(NodeArray& nodes, BlockArray& blocks)
    : nodes_(nodes.beyond()),
      blocks_(blocks.beyond()),
      first_node_(static_cast<std::uint32_t>(nodes.size())),
      first_block_(static_cast<std::uint32_t>(blocks.size())),
      node_room_(nodes.room()),
      block_room_(blocks.room()) {}

void GuestShapes::set_places(std::uint32_t count, const Place& place) {
  if (std::uint64_t{count} * place.nodes > node_room_ || std::uint64_t{count} * place.blocks > block_room_)
    throw SimulationError(
        "the shapes that packets bring from other ranks have not enough numbers; expected a smaller "
        "bvh.treelet_triangles");
  place_ = place;
  filled_.resize(count);
}

NodeRef GuestShapes::enter(std::uint32_t place, std::span<const std::uint64_t> words) {
  Header header;
  if (words.size() >= 2) std::memcpy(static_cast<void*>(&header), words.data(), sizeof header);
  if (words.size() < 2 || words.size() != 2 + header.nodes * kNodeWords + header.blocks * kBlockWords)
    throw SimulationError("a message between ranks has shapes that are cut off");
  if (header.nodes > place_.nodes || header.blocks > place_.blocks)
    throw SimulationError("a packet brings more shapes from another rank than there is room for");
  const std::uint32_t node = place * place_.nodes, block = place * place_.blocks;
  Filled& filled = filled_.at(place);
  std::uint64_t more = 0;
  const auto fill = [&more](auto* begin, std::uint32_t& has, std::uint32_t wanted) {
    if (wanted <= has) return;
    more += (wanted - has) * sizeof *begin;
    SparseMemory::fill(reinterpret_cast<std::byte*>(begin + has), (wanted - has) * sizeof *begin);
    has = wanted;
  };
  fill(nodes_ + node, filled.nodes, header.nodes);
  fill(blocks_ + block, filled.blocks, header.blocks);
  bytes_.fetch_add(more, std::memory_order_relaxed);

  const std::uint64_t* from = words.data() + 2;
  for (std::uint32_t i = 0; i < header.nodes; ++i, from += kNodeWords) {
    Node& to = nodes_[node + i];
    std::memcpy(static_cast<void*>(&to), from, sizeof(Node));
    for (std::uint32_t left = packed_lanes(to, header.subtree != 0); left != 0; left &= left - 1) {
      NodeRef& child = to.child[std::countr_zero(left)];
      child = moved(child, first_node_ + node + child.node(), first_block_ + block + child.first_block());
    }
  }
  if (header.blocks > 0) std::memcpy(static_cast<void*>(blocks_ + block), from, header.blocks * sizeof(TriangleBlock));
  const NodeRef first = NodeRef::from_bits(header.first);
  return moved(first, first_node_ + node + first.node(), first_block_ + block + first.first_block());
}

void pack_shapes(const Accel& accel, NodeRef ref, bool subtree, std::vector<std::uint64_t>& words) {
  Packing packing(accel, subtree);
  const NodeRef first = packing.add(ref);
  packing.write(first, words);
}

}  // namespace carousel::accel

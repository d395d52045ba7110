#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "ringbus/resource/visit/memory_blocks.h"

namespace carousel::ringbus::cycle {

/// The blocks of the simulated memory that collections are keyed by (US 9633468, columns 14 and 34: packets that name a
/// block of memory, not a node). A node belongs to the block in which it begins, and a visit reads from the block's
/// first node to the end of its last one. Immutable; any thread may read.
class ShapeBlocks final : public MemoryBlocks {
 public:
  /// Blocks of `bytes`, from address 0 on.
  ShapeBlocks(const accel::Accel& accel, const ShapeMemory& memory, std::uint64_t bytes);

  accel::NodeKey name(accel::NodeKey node) const override { return {node.instance, block(node.ref).name}; }
  /// The shapes that a visit of the block of `ref` reads.
  ShapeSpan span(accel::NodeRef ref) const { return block(ref).span; }

 private:
  struct Block {
    accel::NodeRef name;
    ShapeSpan span;
  };
  const Block& block(accel::NodeRef ref) const {
    return blocks_[ref.is_inner() ? of_node_[ref.node()] : of_leaf_[ref.first_block()]];
  }

  std::vector<Block> blocks_;
  std::vector<std::uint32_t> of_node_, of_leaf_;  // in blocks_, by node and by a leaf's first block of triangles
};

}  // namespace carousel::ringbus::cycle

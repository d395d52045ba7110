#pragma once

#include "accel/structure/node.h"

namespace carousel::ringbus {

/// Names the blocks of memory in which nodes stand, for an engine whose shapes have addresses (`collections.key:
/// block`).
class MemoryBlocks {
 public:
  virtual ~MemoryBlocks() = default;
  /// The key by which rays that wait at `node` are collected: the first node, or leaf, of its block, in its instance.
  /// Nodes and leaves do not share a block. Any thread may call.
  virtual accel::NodeKey name(accel::NodeKey node) const = 0;
};

}  // namespace carousel::ringbus

#pragma once

#include <cstdint>

#include "accel/accel.h"

namespace carousel::ringbus::cycle {

/// Bytes of shape data and where they stand in the simulated memory.
struct ShapeSpan {
  std::uint64_t address = 0;
  std::uint32_t bytes = 0;
};

/// Where the acceleration structure lies: nodes first, then triangles, as they are laid out in the host's.
class ShapeMemory {
 public:
  explicit ShapeMemory(const accel::Accel& accel) : blocks_at_(accel.nodes.size() * sizeof(accel::Node)) {}

  /// The strip below `key`: a node with its children's boxes, or a leaf's triangles.
  ShapeSpan strip(accel::NodeKey key) const {
    if (key.ref.is_inner()) return {std::uint64_t{key.ref.node()} * sizeof(accel::Node), sizeof(accel::Node)};
    return {blocks_at_ + std::uint64_t{key.ref.first_block()} * sizeof(accel::TriangleBlock),
            key.ref.blocks() * static_cast<std::uint32_t>(sizeof(accel::TriangleBlock))};
  }

 private:
  std::uint64_t blocks_at_;
};

}  // namespace carousel::ringbus::cycle

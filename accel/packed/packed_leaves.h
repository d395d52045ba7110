#pragma once

#include <cstdint>
#include <vector>

#include "accel/packed/packed_block.h"
#include "accel/structure/accel.h"
#include "core/statistics/memory_counts.h"

namespace carousel::accel {

/// The leaves of a structure in compressed blocks (`bvh.leaves: blocks`). Leaves that fit stand together in a block,
/// neighbours in the tree first; a leaf that is too large for one has blocks of its own. Leaves of procedural
/// primitives stand behind all blocks, with 40 bytes for each primitive.
///
/// Immutable once made; any thread may read. Kernels test the triangles of Accel::blocks, which are those that the
/// blocks hold, to the bit.
class PackedLeaves {
 public:
  /// Throws std::logic_error where blocks are decoded to other triangles than `accel` has, which a checked program
  /// looks at.
  explicit PackedLeaves(const Accel& accel);

  struct Place {
    std::uint64_t begin = 0;   ///< bytes behind the first block
    std::uint32_t bytes = 0;   ///< whole blocks, or those of procedural primitives; 0: no leaf
    std::uint32_t blocks = 0;  ///< to decode
    std::uint32_t first = 0;   ///< its first triangle in its first block
    std::uint32_t triangles = 0;
  };
  const Place& place(NodeRef leaf) const { return places_[leaf.first_block()]; }
  const std::vector<PackedBlock>& blocks() const { return blocks_; }
  std::uint64_t bytes() const { return bytes_; }  ///< of all leaves
  const PackedLeafCounts& counts() const { return counts_; }
  /// The triangles of a leaf, decoded from the bits of its blocks.
  std::vector<PackedTriangle> decoded(NodeRef leaf) const;

 private:
  void add(const Accel& accel, NodeRef leaf);
  void add_alone(const std::vector<PackedTriangle>& triangles, Place& place);
  void close();
  void check(const Accel& accel) const;

  std::vector<Place> places_;  // by first block of the leaf in Accel::blocks
  std::vector<NodeRef> leaves_, procedural_;
  std::vector<PackedBlock> blocks_;
  std::vector<PackedTriangle> open_;  // of the block that is being filled
  PackedBlock filled_;                // with them
  std::uint64_t bytes_ = 0;
  PackedLeafCounts counts_;
};

/// Blocks that a test at a node or leaf has decoded before it.
inline std::uint32_t blocks_to_decode(const Accel& accel, NodeRef ref) {
  return accel.packed == nullptr || ref.is_inner() || ref.is_instance() ? 0 : accel.packed->place(ref).blocks;
}

/// The triangles of a leaf as the structure has them.
std::vector<PackedTriangle> triangles_of(const Accel& accel, NodeRef leaf);

}  // namespace carousel::accel

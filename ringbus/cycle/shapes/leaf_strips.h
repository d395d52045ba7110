#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "core/statistics/memory_counts.h"

namespace carousel::ringbus::cycle {

/// Leaves as strips of triangles that share vertices: 12 bytes a vertex, and 4 a triangle for its number, with the end
/// flag of its strip and the order of its vertices, without which hits would not be the same to the bit. Leaves of
/// procedural primitives have 40 bytes for each, as in blocks.
class LeafStrips {
 public:
  LeafStrips() = default;
  explicit LeafStrips(const accel::Accel& accel);

  /// False where leaves are not in strips, and for leaves that nodes hold.
  bool holds(accel::NodeRef leaf) const { return !bytes_.empty() && bytes_[leaf.first_block()] > 0; }
  std::uint64_t begin(accel::NodeRef leaf) const { return begin_[leaf.first_block()]; }  ///< behind the nodes
  std::uint32_t bytes(accel::NodeRef leaf) const { return bytes_[leaf.first_block()]; }
  std::uint64_t bytes() const { return counts_.bytes; }  ///< bytes of all leaves
  const LeafStripCounts& counts() const { return counts_; }

 private:
  void add(const accel::Accel& accel, accel::NodeRef leaf);

  std::vector<std::uint64_t> begin_;  // by first block
  std::vector<std::uint32_t> bytes_;  // likewise; 0: no leaf
  LeafStripCounts counts_;
};

}  // namespace carousel::ringbus::cycle

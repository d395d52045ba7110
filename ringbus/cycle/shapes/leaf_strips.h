#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "ringbus/results/strip_use.h"

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
  std::uint64_t bytes() const { return use_.bytes; }  ///< bytes of all leaves
  const StripUse& use() const { return use_; }

 private:
  void add(const accel::Accel& accel, accel::NodeRef leaf);

  std::vector<std::uint64_t> begin_;  // by first block
  std::vector<std::uint32_t> bytes_;  // likewise; 0: no leaf
  StripUse use_;
};

}  // namespace carousel::ringbus::cycle

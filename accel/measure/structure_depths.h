#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"

namespace carousel::accel {

/// The nodes and leaves of a structure by level and by depth below the root of their own structure. Structures that
/// instances share count once. The whole structure must be here (no Partition).
///
/// Immutable once made; any thread may read.
class StructureDepths {
 public:
  enum class Level : std::uint8_t { kTop, kGroups, kMeshes };
  static constexpr std::uint16_t kNoRow = 0xffff;

  struct Row {
    Level level = Level::kTop;
    std::uint32_t depth = 0;  ///< strips above, within its structure
    std::uint64_t inner = 0, leaves = 0, children = 0;
    /// Inner nodes and blocks of four primitives that a line through the box of a structure of this level meets here,
    /// on average, by the areas of their boxes; mean over the structures, weighted by the references below them.
    double surface_cost = 0;
  };

  explicit StructureDepths(const Accel& accel);

  /// From the top down, all depths of a level one behind the other.
  const std::vector<Row>& rows() const { return rows_; }
  /// The row of a node or leaf that a ray may come to; kNoRow for others.
  std::uint16_t row(NodeRef ref) const { return ref.is_inner() ? of_node_[ref.node()] : of_leaf_[ref.first_block()]; }

 private:
  std::vector<Row> rows_;
  std::vector<std::uint16_t> of_node_, of_leaf_;  // by node, and by a leaf's first block
};

}  // namespace carousel::accel

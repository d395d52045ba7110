#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/node.h"

namespace carousel::accel {

/// The whole tree cut into connected pieces (`bvh.treelets`): every node, and every leaf with a box of its own,
/// to which rays can come is in exactly one. A piece is entered at its root alone, since the parent of each other node
/// is in it too. No piece goes over the border of a structure, so that all placements of a mesh share its pieces.
/// Immutable once made.
struct TreePieces {
  struct Piece {
    NodeRef root;
    std::uint64_t address =
        0;                    ///< of its first byte; the pieces stand one behind another, each from a 64-byte border on
    std::uint32_t bytes = 0;  ///< of its nodes and leaves, without gaps
    std::uint32_t nodes = 0, leaves = 0;
    std::uint32_t exits = 0;  ///< children that are in other pieces, instances among them
  };

  static constexpr std::uint32_t kNowhere = ~0u;

  std::vector<Piece> pieces;
  std::vector<std::uint32_t> of_node, of_leaf;  ///< index in `pieces`, or kNowhere, by node and by a leaf's first block
  std::vector<std::uint64_t> node_at, leaf_at;  ///< addresses, likewise
  std::uint64_t bytes = 0;                      ///< of all pieces, gaps included
  std::uint32_t most_exits = 0;
  int depth = 0;  ///< pieces on the longest way down, through all levels of the structure

  /// The piece of a node or leaf to which rays can come.
  std::uint32_t index(NodeRef ref) const { return ref.is_inner() ? of_node[ref.node()] : of_leaf[ref.first_block()]; }
  bool holds(NodeRef ref) const { return index(ref) != kNowhere; }
  const Piece& piece(NodeRef ref) const { return pieces[index(ref)]; }
  std::uint64_t address(NodeRef ref) const { return ref.is_inner() ? node_at[ref.node()] : leaf_at[ref.first_block()]; }
  /// True if `child`, a child of `parent`, is in the same piece.
  bool together(NodeRef parent, NodeRef child) const { return !child.is_instance() && index(parent) == index(child); }
};

}  // namespace carousel::accel

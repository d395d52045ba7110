#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/structure/node.h"

namespace carousel::accel {

struct Accel;

/// Room for shapes of other ranks that are here while a packet that carries them is. It lies behind a rank's own
/// arrays, so that tests find a guest as they find any shape, by a number, which means nothing on other ranks.
class GuestShapes {
 public:
  /// Each place holds so much at most, and gets memory when it is first needed.
  struct Place {
    std::uint32_t nodes = 1, blocks = 4;
  };
  /// Behind the arrays, which have to be complete.
  GuestShapes(NodeArray& nodes, BlockArray& blocks);

  /// Before the first guest. Throws a SimulationError where numbers do not suffice for so many places.
  void set_places(std::uint32_t count, const Place& place);
  /// Writes shapes that pack_shapes() has packed into a place, and returns what to call the first of them here. Throws
  /// a SimulationError where they do not fit, or are none. The places of two threads have to differ.
  NodeRef enter(std::uint32_t place, std::span<const std::uint64_t> words);
  /// Memory of all places so far.
  std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  struct Filled {
    std::uint32_t nodes = 0, blocks = 0;  // that have memory
  };

  Node* nodes_;
  TriangleBlock* blocks_;
  std::uint32_t first_node_, first_block_;
  std::uint64_t node_room_, block_room_;
  Place place_;
  std::vector<Filled> filled_;
  std::atomic<std::uint64_t> bytes_{0};
};

/// Appends the data that a test of `ref` reads: a node, with the leaves that it holds itself, or a leaf; with `subtree`
/// all that is below. References among them are by number within the packing; others stay as they are.
void pack_shapes(const Accel& accel, NodeRef ref, bool subtree, std::vector<std::uint64_t>& words);

}  // namespace carousel::accel

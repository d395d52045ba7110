#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace carousel {

/// A packet that waits at the front of a resource's input queue, oldest first.
struct WaitingPacket {
  bool may_go = false;      ///< it finds the place and the test context that it needs; only such a packet can be taken
  bool has_shapes = false;  ///< none of its shapes has to come from memory
  bool own = false;         ///< it has come home
  bool tests = false;       ///< some of its rays are tested here
  std::uint32_t rays = 0;   ///< whose IDs or results it carries
  std::uint32_t depth = 0;  ///< of its node in the tree, in strips below the root
};

/// A dispatch that a plugin brings (`testers.dispatch`): the choice of a resource among the packets in its window
/// (`testers.window`). Another packet than the first one costs a cycle, and the first one is passed over at most as
/// often as the window is long; then it is shown alone.
struct DispatchRule {
  /// The place of the packet to take; one of them may go at least. Called from the threads of all resources. The same
  /// packets must give the same answer.
  std::size_t (*choose)(std::span<const WaitingPacket> packets) = nullptr;
};

}  // namespace carousel

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "core/config/fields/collections.h"
#include "core/statistics/intersection_counts.h"
#include "ringbus/packets/packet.h"
#include "ringbus/resource/visit/transform_account.h"

namespace carousel::ringbus::cycle {

/// Walks one ray through a tree, depth-first and in either order of the children hit, a strip at a time.
///
/// Nodes wait on a stack, an entry of 32 bits for an inner node and of 96 for a leaf; the walk goes on with the first
/// child at once, which is never put there. The transformed copy of the ray is kept while the ray is within an
/// instance. The transform account decides whether it is made anew when the ray comes there again.
class RayWalk {
 public:
  /// Keeps a reference.
  RayWalk(TransformAccount& transforms, ChildOrder order) : transforms_(&transforms), order_(order) {}
  void start(accel::NodeKey from) { start(from, nullptr); }
  /// With `pieces` the walk stays in the piece of `from`, and exits() are the children outside that it has hit. With
  /// `in_rounds` a ray that looks for several hits goes on with its next round where the walk would end
  /// (accel::NearestRay).
  void start(accel::NodeKey from, const accel::TreePieces* pieces, bool in_rounds = false);
  /// The strip that the ray has to be tested against next; nothing when it is through or needs no more tests. The
  /// oldest `beyond` entries of the stack are not at hand: where nothing else is left, there is nothing either. A round
  /// begins where all strips that next() has given have been `tested`.
  std::optional<accel::NodeKey> next(const RayRecord& record, std::size_t beyond = 0, bool tested = true);
  /// Tests the ray, the one member of `ray`, against that strip. Adds the tests that the hardware has to make to
  /// `counts`. Several strips that next() has given may be tested one after another.
  void test(const accel::Accel& accel, accel::NodeKey key, const accel::RayMembers& ray, IntersectionCounts& counts);
  /// As above, alone.
  IntersectionCounts test(const accel::Accel& accel, accel::NodeKey key, const accel::RayMembers& ray) {
    IntersectionCounts counts;
    test(accel, key, ray, counts);
    return counts;
  }

  /// In the order in which they were met; those of one node in the order in which they would be visited.
  const std::vector<NextNode>& exits() const { return exits_; }

  /// Tells whether `instance` is another one than that of the last strip.
  bool enters(std::uint32_t instance) const { return instance != instance_; }

  /// Bytes on the stack now, and moved onto it and from it since start().
  struct StackBytes {
    std::uint64_t held = 0, pushed = 0, popped = 0;
  };
  const StackBytes& stack_bytes() const { return bytes_; }
  /// The entries on the stack, without the first child.
  std::size_t entries() const { return stack_.size() - (next_in_hand_ ? 1 : 0); }
  /// The bytes of the entries from `first` to before `last`, counted from the oldest.
  std::uint64_t bytes_of(std::size_t first, std::size_t last) const;

 private:
  NextNode pop();
  void enter(std::uint32_t instance, std::uint32_t slot, IntersectionCounts& counts);

  TransformAccount* transforms_;
  ChildOrder order_;
  std::vector<NextNode> stack_;  // and on top of it the first child
  bool next_in_hand_ = false;
  const accel::TreePieces* pieces_ = nullptr;
  bool in_rounds_ = false;
  std::vector<NextNode> exits_;
  std::uint16_t depth_ = 0;  // of the last strip, below that at which the walk began
  std::uint32_t instance_ = kNoInstance;
  StackBytes bytes_;
};

}  // namespace carousel::ringbus::cycle

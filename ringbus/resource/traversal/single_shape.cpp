#include "ringbus/resource/traversal/single_shape.h"

#include <algorithm>
#include <bit>

namespace carousel::ringbus {

std::int32_t SingleShapeTraversal::tests_at(const accel::Accel& accel, const Treelets& treelets, accel::NodeKey key) {
  return treelets.contains(key) ? 1 : std::max(1, accel.strip_size(key));
}

std::uint32_t SingleShapeTraversal::blocks_needed(accel::NodeKey key, std::uint32_t) const {
  if (!key.ref.is_inner()) return 0;
  std::int32_t most = 1;
  for (int lane = 0; per_child_ && lane < context_.accel.nodes[key.ref.node()].count; ++lane)
    most = std::max(most, tests_below(key, lane));
  return static_cast<std::uint32_t>(most);
}

std::int32_t SingleShapeTraversal::tests_below(accel::NodeKey key, int lane) const {
  // In a partitioned scene the child may be at another rank; there are no treelets then.
  const accel::Accel& accel = context_.accel;
  return accel.partition ? accel.child_strip_size(key, lane) : tests_at(accel.child_key(key, lane));
}

void SingleShapeTraversal::answer(Packet& packet, const LocalRays& local, const std::vector<std::uint8_t>& masks) {
  const int lane = std::countr_zero(packet.lanes);
  const std::int32_t below = tests_below(packet.key, lane);
  for (std::size_t i = 0; i < local.size(); ++i) {
    packet.members[local.members[i]].mask = masks[i];
    context_.completion.add_pending(local.slots[i], (masks[i] != 0 ? below : 0) - 1);
  }
}

}  // namespace carousel::ringbus

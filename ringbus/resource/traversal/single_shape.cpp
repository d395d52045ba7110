#include "ringbus/resource/traversal/single_shape.h"

#include <algorithm>
#include <bit>

namespace carousel::ringbus {

std::int32_t SingleShapeTraversal::tests_at(const accel::Accel& accel, const Treelets& treelets, accel::NodeKey key) {
  return treelets.contains(key) ? 1 : std::max(1, accel.strip_size(key));
}

void SingleShapeTraversal::answer(Packet& packet, const LocalRays& local, const std::vector<std::uint8_t>& masks) {
  const int lane = std::countr_zero(packet.lanes);
  const accel::Accel& accel = context_.accel;
  // Of a partitioned scene the child may be at another rank; there are no treelets then.
  const std::int32_t below =
      accel.partition ? accel.child_strip_size(packet.key, lane) : tests_at(accel.child_key(packet.key, lane));
  for (std::size_t i = 0; i < local.size(); ++i) {
    packet.members[local.members[i]].mask = masks[i];
    context_.completion.add_pending(local.slots[i], (masks[i] != 0 ? below : 0) - 1);
  }
}

}  // namespace carousel::ringbus

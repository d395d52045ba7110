#include "ringbus/resource/traversal/spread.h"

#include <bit>

#include "accel/traverse/kernels.h"
#include "ringbus/resource/visit/count_children.h"

namespace carousel::ringbus {

std::uint32_t SpreadTraversal::blocks_needed(accel::NodeKey key, std::uint32_t) const {
  return key.ref.is_inner() ? context_.accel.nodes[key.ref.node()].count : 0;
}

void SpreadTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  const TransformCharge charge(context_, local.slots, packet.key.instance);
  const accel::RayMembers members = context_.members(local.slots);
  if (context_.store.nearest() != nullptr) context_.store.nearest()->visited(context_.store.records(), local.slots);
  if (packet.key.ref.is_inner()) {
    masks_.resize(local.size());
    accel::test_strip(context_.accel, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, nullptr},
                      outcome.counts);
    context_.any_hit.hold_back();
    count_children(masks_, outcome);
    answer(packet, local, masks_);
  } else {
    accel::test_strip(context_.accel, packet.key, packet.lanes, members, {}, outcome.counts);
    context_.any_hit.hold_back();
    for (const std::uint32_t slot : local.slots) context_.completion.add_pending(slot, -1);
  }
  charge.write(outcome.counts);
}

void SpreadTraversal::answer(Packet& packet, const LocalRays& local, const std::vector<std::uint8_t>& masks) {
  for (std::size_t i = 0; i < local.size(); ++i) {
    packet.members[local.members[i]].mask = masks[i];
    context_.completion.add_pending(local.slots[i], kBitCount[masks[i]] - 1);
  }
}

void SpreadTraversal::retire(const Packet& packet, CollectionStore& collections) {
  if (!packet.key.ref.is_inner()) return;
  std::uint32_t lanes = 0;
  for (const PacketMember& member : packet.members) lanes |= member.mask;
  ids_.resize(packet.members.size());
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    // No branch predictor guesses which members hit: each is written, and counted if it did.
    std::size_t count = 0;
    for (const PacketMember& member : packet.members) {
      ids_[count] = member.ray;
      count += (member.mask >> lane) & 1u;
    }
    const std::int32_t shapes = collections_below(packet.key, lane);
    for (std::int32_t shape = 0; shape < shapes; ++shape)
      collections.add(context_.accel.child_key(packet.key, lane), static_cast<std::uint16_t>(packet.depth + 1),
                      packet.nearest[lane], std::span(ids_).first(count), static_cast<std::uint8_t>(shape));
  }
}

}  // namespace carousel::ringbus

#include "ringbus/resource/traversal/spread.h"

#include <array>
#include <bit>

#include "accel/traverse/kernels.h"

namespace carousel::ringbus {

namespace {

// The baseline instruction set has no population count, and a call for eight bits is dear.
constexpr std::array<std::int8_t, 256> kBitCount = [] {
  std::array<std::int8_t, 256> counts{};
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] = static_cast<std::int8_t>(counts[i / 2] + (i & 1));
  return counts;
}();

}  // namespace

std::uint32_t SpreadTraversal::blocks_needed(accel::NodeKey key, std::uint32_t) const {
  return key.ref.is_inner() ? context_.accel.nodes[key.ref.node()].count : 0;
}

void SpreadTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  const TransformCharge charge(context_, local.slots, packet.key.instance);
  const accel::RayMembers members = context_.members(local.slots);
  if (packet.key.ref.is_inner()) {
    masks_.resize(local.size());
    accel::test_strip(context_.accel, packet.key, packet.lanes, members, {masks_.data(), packet.nearest, nullptr},
                      outcome.counts);
    context_.any_hit.hold_back(local.slots);
    answer(packet, local, masks_);
  } else {
    accel::test_strip(context_.accel, packet.key, packet.lanes, members, {}, outcome.counts);
    context_.any_hit.hold_back(local.slots);
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
    collections.add(context_.accel.child_key(packet.key, lane), static_cast<std::uint16_t>(packet.depth + 1),
                    packet.nearest[lane], std::span(ids_).first(count));
  }
}

}  // namespace carousel::ringbus

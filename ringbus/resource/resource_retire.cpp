// A packet is back at its owner: its members move on to the collections of what they hit.
#include <bit>

#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

void Resource::retire(Packet& packet) {
  std::uint32_t joined = 0;
  if (packet.kind == PacketKind::kTest) {
    const std::size_t before = collections_.memberships();
    if (ordered_)
      retire_ordered(packet);
    else if (packet.key.ref.is_inner() && !is_treelet(packet.key))
      retire_spread(packet);
    joined = static_cast<std::uint32_t>(collections_.memberships() - before);
  }
  // Custody bounds the storage of ordered rays, which are in one place at a time and stay with their issuer.
  if (ordered_ && bounded_) rays_held_ -= static_cast<std::uint32_t>(packet.members.size()) - joined;
  reserved_blocks_ -= packet.reserved_blocks;
  --in_flight_;
  record({.kind = EventKind::kRetire, .resource = id(), .key = packet.key, .rays = joined, .members = packet.members});
}

void Resource::retire_spread(Packet& packet) {
  std::uint32_t lanes = 0;
  for (const PacketMember& member : packet.members) lanes |= member.mask;
  ids_.resize(packet.members.size());
  for (; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    // Which members hit is a coin toss no predictor guesses: each is written, and counted if it did.
    std::size_t count = 0;
    for (const PacketMember& member : packet.members) {
      ids_[count] = member.ray;
      count += (member.mask >> lane) & 1u;
    }
    collections_.add(accel_.child_key(packet.key, lane), static_cast<std::uint16_t>(packet.depth + 1),
                     packet.nearest[lane], std::span(ids_).first(count));
  }
}

void Resource::retire_ordered(Packet& packet) {
  for (std::size_t i = 0; i < packet.members.size(); ++i) {
    const NextNode& next = packet.next[i];
    if (next.any) collections_.add(next.key, next.depth, next.entry, {&packet.members[i].ray, 1});
  }
}

void Resource::join(Packet& packet) {
  ids_.clear();
  for (const PacketMember& member : packet.members) ids_.push_back(member.ray);
  collections_.add(packet.key, packet.depth, packet.nearest[0], ids_);
  packet.members.clear();
}

}  // namespace carousel::ringbus

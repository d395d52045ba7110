// A packet is back at its owner: its members move on to the collections of what they hit.
#include <bit>

#include "ringbus/resource.h"

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
  if (ordered_ && bounded_) custody_ -= static_cast<std::uint32_t>(packet.members.size()) - joined;
  reserved_blocks_ -= packet.reserved_blocks;
  --in_flight_;
  record({.kind = EventKind::kRetire, .resource = id(), .key = packet.key, .rays = joined, .members = packet.members});
}

void Resource::retire_spread(Packet& packet) {
  for (const PacketMember& member : packet.members)
    for (std::uint32_t rest = member.mask; rest != 0; rest &= rest - 1)
      lane_ids_[static_cast<std::size_t>(std::countr_zero(rest))].push_back(member.ray);
  for (int lane = 0; lane < accel::kMaxWidth; ++lane) {
    std::vector<RayId>& ids = lane_ids_[static_cast<std::size_t>(lane)];
    if (ids.empty()) continue;
    collections_.add(accel_.child_key(packet.key, lane), static_cast<std::uint16_t>(packet.depth + 1),
                     packet.nearest[lane], ids);
    ids.clear();
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

#pragma once

#include <algorithm>
#include <iterator>

#include "ringbus/packets/packet.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus {

/// Makes the answer of resource `here` to a test packet that it has heard: a copy, to be tested here. The packet itself
/// stays as it is, since others read it at the same time.
inline Packet& begin_answer(Machine& machine, ResourceId here, PacketId id) {
  return machine.answer(here, id) = machine.packet(id);
}

/// How many rays of the answer live at `here`: it has no others on its way to the packet's owner.
inline std::size_t rays_in_answer(Machine& machine, ResourceId here, PacketId id) {
  const RayIdLayout& layout = machine.stores.front()->layout();
  const std::vector<PacketMember>& members = machine.answer(here, id).members;
  return static_cast<std::size_t>(std::count_if(
      members.begin(), members.end(), [&](const PacketMember& member) { return layout.owner(member.ray) == here; }));
}

/// Writes all answers into a packet that is to retire, in the order of the resources.
inline void collect_answers(Machine& machine, PacketId id) {
  Packet& packet = machine.packet(id);
  const RayIdLayout& layout = machine.stores.front()->layout();
  const std::size_t members = packet.members.size();
  for (std::uint32_t r = 0; r < machine.topology.resources(); ++r) {
    const ResourceId from(r);
    if (from == packet.owner || !machine.topology.wanted(packet, from)) continue;
    const Packet& answer = machine.answer(from, id);
    for (std::size_t i = 0; i < members; ++i) {
      if (layout.owner(packet.members[i].ray) != from) continue;
      packet.members[i] = answer.members[i];
      if (!packet.next.empty()) packet.next[i] = answer.next[i];
    }
    // Rays of bundles that were taken apart.
    packet.members.insert(packet.members.end(), answer.members.begin() + static_cast<std::ptrdiff_t>(members),
                          answer.members.end());
    for (std::size_t lane = 0; lane < std::size(packet.nearest); ++lane)
      packet.nearest[lane] = std::min(packet.nearest[lane], answer.nearest[lane]);
  }
}

}  // namespace carousel::ringbus

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/packets/packet.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Members of a packet whose results go on before the others'.
struct PacketPart {
  Packet packet;
  std::vector<std::uint32_t> slots;  ///< of its members
  HitBatch completed;                ///< those of them that are complete, with their slots
  std::vector<std::uint32_t> freed_slots;

  /// Moves the rays of `slots` out of those that a visit has completed.
  void take_completed(HitBatch& rays, std::vector<std::uint32_t>& rays_slots) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (std::find(slots.begin(), slots.end(), rays_slots[i]) != slots.end()) {
        completed.push_back(rays[i]);
        freed_slots.push_back(rays_slots[i]);
      } else {
        rays[kept] = rays[i];
        rays_slots[kept++] = rays_slots[i];
      }
    }
    rays.resize(kept);
    rays_slots.resize(kept);
  }
};

/// When the results of a packet's members go on from the decision point behind a distributor. All members are tested
/// at one resource.
struct ResultTimes {
  std::vector<std::uint32_t> slots;  ///< of the members
  std::vector<Cycle> cycles;         ///< of their results

  std::size_t size() const { return slots.size(); }
  Cycle first() const { return *std::min_element(cycles.begin(), cycles.end()); }
  Cycle last() const { return *std::max_element(cycles.begin(), cycles.end()); }
  std::size_t due(Cycle now) const {
    return static_cast<std::size_t>(std::count_if(cycles.begin(), cycles.end(), [&](Cycle at) { return at <= now; }));
  }

  /// Moves the members whose results are due from `packet` to `part`, and their slots to `part_slots`.
  void take_due(Cycle now, Packet& packet, Packet& part, std::vector<std::uint32_t>& part_slots) {
    part.kind = packet.kind;
    part.owner = packet.owner;
    part.home = packet.home;
    part.key = packet.key;
    part.lanes = packet.lanes;
    part.depth = packet.depth;
    std::copy(std::begin(packet.nearest), std::end(packet.nearest), std::begin(part.nearest));
    part.members.clear();
    part.next.clear();
    part_slots.clear();
    const bool has_next = !packet.next.empty();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (cycles[i] <= now) {
        part.members.push_back(packet.members[i]);
        if (has_next) part.next.push_back(packet.next[i]);
        part_slots.push_back(slots[i]);
        continue;
      }
      packet.members[kept] = packet.members[i];
      if (has_next) packet.next[kept] = packet.next[i];
      slots[kept] = slots[i];
      cycles[kept++] = cycles[i];
    }
    packet.members.resize(kept);
    if (has_next) packet.next.resize(kept);
    slots.resize(kept);
    cycles.resize(kept);
    const auto moved = static_cast<std::uint32_t>(part.members.size());
    part.answered = std::min(packet.answered, moved);
    packet.answered -= part.answered;
  }
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus {

/// The members of a packet that live at the resource it visits: two lists of the same length. With bundles a slot may
/// be a bundle's.
struct LocalRays {
  std::vector<std::uint32_t> slots;    ///< in the resource's store
  std::vector<std::uint32_t> members;  ///< indices into Packet::members

  std::size_t size() const { return slots.size(); }
  bool empty() const { return slots.empty(); }

  void gather(const Packet& packet, const RayStore& store) {
    slots.resize(packet.members.size());
    members.resize(packet.members.size());
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < packet.members.size(); ++i) {
      const RayId ray = packet.members[i].ray;
      const bool local = store.owns(ray);
      // Every member is written, and counted if it is local: with two owners no branch predictor guesses which.
      slots[count] = local ? store.slot(ray) : 0;
      members[count] = i;
      count += local;
    }
    slots.resize(count);
    members.resize(count);
  }
};

}  // namespace carousel::ringbus

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/numeric/grow.h"
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
    const std::size_t n = packet.members.size();
    grow_to(found_, 2 * n);
    std::uint32_t* const slot_of = found_.data();
    std::uint32_t* const member_of = slot_of + n;
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const RayId ray = packet.members[i].ray;
      const bool local = store.owns(ray);
      // Every member is written, and counted if it is local: with two owners no branch predictor guesses which.
      slot_of[count] = local ? store.slot(ray) : 0;
      member_of[count] = i;
      count += local;
    }
    slots.assign(slot_of, slot_of + count);
    members.assign(member_of, member_of + count);
  }

 private:
  // Both lists with room for all members. The lists themselves would be filled with zeros each time they grow.
  std::vector<std::uint32_t> found_;
};

}  // namespace carousel::ringbus

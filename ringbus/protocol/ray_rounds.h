#pragma once

#include <cstddef>
#include <vector>

#include "ringbus/packets/packet.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/rays/ray_control.h"

namespace carousel::ringbus {

/// New rays that travel round the ring in packets to find slots (`rays.placement: first_taker` and `addressed`), seen
/// from one resource: the groups that wait here for a packet, and what happens to a packet of rays that is here.
class RayRounds {
 public:
  /// Keeps a reference.
  RayRounds(Machine& machine, ResourceId here) : machine_(machine), here_(here) {}

  /// Makes a group's rays wait here; the group is left without rays.
  void add(RayGroup& group);
  /// Takes the waiting groups, oldest first. `groups` must be empty.
  void take_waiting(std::vector<RayGroup>& groups) { groups.swap(waiting_); }
  bool empty() const { return waiting_.empty(); }
  std::size_t rays() const;

  /// Tells whether some resource that may take rays of the group has a free slot.
  bool has_room(const RayGroup& group) const;
  /// Puts a group's rays into a packet, for a round of all resources. The group is left without rays.
  void load(RayGroup& group, Packet& packet) const;
  /// Gives the rays of a packet the free slots of this resource, as far as its share goes, and writes their IDs into
  /// the packet. With `home: local` it returns the IDs instead, for those rays start from here.
  std::vector<RayId> take_slots(Packet& packet);
  /// Takes out of a packet that is back at its owner the IDs of the rays that found a slot and the rays that did not.
  RayGroup unload(Packet& packet) const;

 private:
  Machine& machine_;
  ResourceId here_;
  std::vector<RayGroup> waiting_;
};

}  // namespace carousel::ringbus

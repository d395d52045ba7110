#pragma once

#include <cstdint>
#include <vector>

#include "core/config/config.h"
#include "core/types/ids.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// Who is wired to whom and which way packets go. `directions` counts the independent cycles a packet can be
/// sent round: 1 for a ring, 2 for a bidirectional one, one a ring of several; point to point and bus have one
/// cycle too, with short cuts.
///
/// Hierarchical: the resources of a group form a line from their group's bridge back to it, and the bridges a ring.
/// A packet goes through the rest of its own group, then round the bridges, into those groups that want it, and at
/// last into its own again.
///
/// Nodes beyond the resources: the bus, or the bridges by group.
class Topology {
 public:
  explicit Topology(const TopologyConfig& config);

  /// `direction`: of a ring; hierarchical: 0 within a group, 1 between bridges.
  struct Wire {
    ResourceId from, to;
    std::uint16_t direction;
  };
  /// Every link to make. None when there is only one resource, or all work independently.
  const std::vector<Wire>& wires() const { return wires_; }
  std::size_t resources() const { return resources_; }
  std::size_t directions() const { return directions_; }
  /// Whether a packet is sent from one stop to the next without passing others.
  bool direct() const { return shape_ == TopologyShape::kPointToPoint || shape_ == TopologyShape::kBus; }
  bool bus() const { return shape_ == TopologyShape::kBus; }
  /// Groups of a hierarchical topology, 0 of another.
  std::uint32_t groups() const { return groups_; }
  std::uint32_t group_of(ResourceId r) const { return r.value * groups_ / resources_; }
  ResourceId first_of(std::uint32_t group) const { return ResourceId((group * resources_ + groups_ - 1) / groups_); }
  ResourceId last_of(std::uint32_t group) const { return ResourceId(first_of(group + 1).value - 1); }

  /// Links a packet crosses on its way round; 0 when it need not travel.
  std::uint32_t hops(const Packet& packet) const;
  /// Where the packet at `here` goes next, its owner at last. Point to point with `visit: owners` skips
  /// resources that own none of the members.
  ResourceId next(const Packet& packet, ResourceId here) const;
  /// Resources that a packet sent from `here` passes before one that has work with it (none when `direct`); the
  /// second form counts from the entrance of a group.
  std::uint16_t skip(const Packet& packet, ResourceId here) const;
  std::uint16_t skip_from_entrance(const Packet& packet, std::uint32_t group) const;
  /// Whether a packet that has reached the group's bridge has anything to do in the group, its owner included.
  bool group_wants(const Packet& packet, std::uint32_t group) const;
  /// Whether the packet has to be handled at `here`, or just cuts through.
  bool handles(const Packet& packet, ResourceId here) const;
  /// Whether the packet has anything to do at `r`, its owner apart.
  bool wanted(const Packet& packet, ResourceId r) const;

 private:
  ResourceId follower(std::uint16_t direction, ResourceId here) const;
  std::uint16_t skip_to(const Packet& packet, std::uint32_t at, std::uint32_t end) const;
  void wire_groups();

  TopologyShape shape_;
  std::uint32_t resources_, groups_;
  std::uint16_t directions_;
  bool visit_all_;
  std::vector<Wire> wires_;
};

/// How many packets each resource may have on the way at once, per direction (DESIGN.md section 4).
std::uint32_t packets_in_flight(const TopologyConfig& config);

}  // namespace carousel::ringbus

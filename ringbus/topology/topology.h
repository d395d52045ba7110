#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/config/fields/topology.h"
#include "core/types/ids.h"
#include "ringbus/packets/packet.h"
#include "ringbus/topology/plan.h"

// A new topology takes these places and no others (docs/guides/extending.md):
//   1. its value in TopologyShape with its name and its properties (core/config/fields/topology.h); if one engine alone
//      can run it, also its place in `.only` on the row of the key there;
//   2. its drawing in drawn_shape.cpp, from which its plan follows;
//   3. its row in the table of shapes.cpp.
// A hub of a new kind also needs a kind of node, and an agent of the cycle engine (cycle/fabric).

namespace carousel::ringbus {

/// Says who is wired to whom and which way packets go: the tables of one shape's plan, without a virtual call or a
/// case distinction by shape.
class Topology {
 public:
  using Wire = TopologyPlan::Wire;
  using Hub = TopologyPlan::Hub;

  explicit Topology(const TopologyConfig& config);
  /// `plan`: by plan_topology() or plan_traffic().
  Topology(const TopologyConfig& config, TopologyPlan plan);

  /// Every link to make. None when there is only one resource, or all work independently.
  const std::vector<Wire>& wires() const { return plan_.wires; }
  /// Indices into wires() of the links that enter and leave a node, by port.
  struct Ports {
    std::vector<std::uint32_t> in, out;
  };
  const Ports& ports(ResourceId node) const { return ports_[node.value]; }
  /// The port by which a link leaves its first node; `wire`: its index.
  std::size_t out_port_of(std::size_t wire) const { return out_port_of_[wire]; }
  std::size_t resources() const { return resources_; }
  std::size_t directions() const { return plan_.successors.size(); }
  /// Nodes `resources()` and up.
  const std::vector<Hub>& hubs() const { return plan_.hubs; }

  bool direct() const { return plan_.direct; }
  /// Packets find their way from stop to stop by exit().
  bool routed() const { return plan_.routed; }
  /// The way of a packet of this direction out of a node to a resource that is another node; only where packets are
  /// routed.
  TopologyPlan::Exit exit(ResourceId node, ResourceId stop, std::size_t direction = 0) const {
    return plan_.exits[(node.value * directions() + direction) * std::size_t{resources_} + stop.value];
  }
  /// A node that is a ring whose stops have no queues: nothing anywhere else.
  const TopologyPlan::StopRing* ring(ResourceId node) const {
    const std::size_t first = resources_ + plan_.hubs.size() - plan_.rings.size();
    return node.value < first ? nullptr : &plan_.rings[node.value - first];
  }
  /// The number of such a node among the rings.
  std::size_t ring_number(ResourceId node) const {
    return node.value - (resources_ + plan_.hubs.size() - plan_.rings.size());
  }
  /// The stop at which a packet for `to` leaves the ring that it has got onto at the stop `from`.
  ResourceId leaves_at(const TopologyPlan::StopRing& ring, ResourceId from, ResourceId to) const {
    return ring.off[ring.places[from.value] * std::size_t{resources_} + to.value];
  }
  /// The virtual channels of links, under synthetic traffic; only where packets are routed.
  const ChannelPlan& channels() const { return plan_.channels; }
  /// Flits of a packet go from node to node one by one; likewise.
  bool flits_apart() const { return plan_.flits_apart; }
  /// The time in which the first packet of a queue claims a channel; likewise.
  std::uint32_t claim_cycles(ResourceId node) const { return plan_.claim_cycles[node.value]; }
  /// The clock of a node in MHz; 0: that of the resources.
  std::int64_t mhz(ResourceId node) const { return plan_.node_mhz.empty() ? 0 : plan_.node_mhz[node.value]; }
  /// No link waits for another, and no rule has to keep them from filling up.
  bool room_for_all() const { return plan_.room_for_all; }
  /// Egress places of a hub for each port; 0: for all packets there are.
  std::uint32_t hub_places(std::size_t hub) const { return plan_.hub_places.empty() ? 0 : plan_.hub_places[hub]; }
  /// Links are of more than one width.
  bool has_widths() const { return has_widths_; }
  /// All resources hear what one sends. A packet goes to all of them at once, and each that has rays of it answers.
  bool broadcasts() const { return !plan_.hubs.empty() && plan_.hubs.front() == Hub::kBus; }
  bool visits_all() const { return visit_all_; }
  bool has_packets() const { return properties_.has_packets; }
  bool carries_traffic() const { return properties_.carries_traffic; }
  std::uint32_t packets_in_flight() const { return plan_.packets_in_flight; }
  std::uint16_t ack_direction(std::size_t direction) const { return plan_.ack_directions[direction]; }
  /// As in the plan.
  const std::vector<std::uint32_t>& manager_of() const { return plan_.manager_of; }
  const DeadlockVerdict& verdict() const { return plan_.verdict; }

  /// Links that a packet crosses on its way round a ring; 0 when it need not travel.
  std::uint32_t hops(const Packet& packet) const;
  /// The next stop of the packet at `here`, its owner at last. Where packets are sent directly or routed and only
  /// owners are visited, resources that own none of the members are left out.
  ResourceId next(const Packet& packet, ResourceId here) const {
    const ResourceId* round = round_of(packet.direction);
    ResourceId at = round[here.value];
    if (!skips_ahead_) return at;
    while (at != packet.owner && !wanted(packet, at)) at = round[at.value];
    return at;
  }
  /// The port by which the packet leaves the resource `here`.
  std::size_t out_port(const Packet& packet, ResourceId here) const {
    if (plan_.routed) return exit(here, next(packet, here), packet.direction).port;
    if (!plan_.direct) return packet.direction;
    return ports_to_.empty() ? 0 : out_port_to(here, next(packet, here));
  }
  /// The port that leads straight to `to`, where every resource has one.
  std::size_t out_port_to(ResourceId here, ResourceId to) const {
    return ports_to_[here.value * std::size_t{resources_} + to.value];
  }
  /// Resources that a packet sent from `here` passes before one that has work with it; none where packets are sent
  /// directly. Where they are routed it counts stops.
  std::uint16_t skip(const Packet& packet, ResourceId here) const {
    if (plan_.direct || (plan_.routed && !visit_all_)) return 0;
    const ResourceId* round = round_of(packet.direction);
    std::uint16_t skip = 0;
    for (ResourceId at = round[here.value]; at != packet.owner && !wanted(packet, at); at = round[at.value]) ++skip;
    return skip;
  }
  /// Resources other than its owner that have rays of a test packet.
  std::uint32_t other_owners(const Packet& packet) const {
    std::uint32_t others = 0;
    for (const std::uint64_t word : packet.owners) others += static_cast<std::uint32_t>(std::popcount(word));
    return others - (wanted(packet, packet.owner) ? 1 : 0);
  }
  /// Tells whether the packet has anything to do at `r`, leaving aside that `r` may be its owner.
  bool wanted(const Packet& packet, ResourceId r) const {
    if (packet.kind == PacketKind::kTest) [[likely]]
      return (packet.owners[r.value / 64] >> (r.value % 64) & 1) != 0;
    return packet.kind == PacketKind::kRays || r == packet.home;
  }

  /// The way of a packet that has one destination (synthetic traffic).
  struct Route {
    std::uint16_t direction = 0;
    std::uint16_t hops = 0;  ///< links to cross; 0: it is there already
  };
  /// The shortest way. Equally short ways are spread by `random` (as BookSim2's dim_order routing on a torus). Only
  /// where traffic runs.
  Route route(ResourceId from, ResourceId to, std::uint32_t random) const;

 private:
  const ResourceId* round_of(std::uint16_t direction) const {
    return successors_.data() + direction * std::size_t{resources_};
  }
  std::uint16_t links_between(std::size_t direction, ResourceId from, ResourceId to) const;
  void number_ports();
  void number_positions();
  Route routed_way(ResourceId from, ResourceId to) const;

  TopologyPlan plan_;
  ShapeProperties properties_;
  std::uint32_t resources_;
  bool visit_all_;
  bool skips_ahead_;  // next() leaves out resources without members
  bool has_widths_;
  std::vector<ResourceId> successors_;      // the plan's, direction after direction
  std::vector<std::uint32_t> position_;     // likewise: links from resource 0; empty without traffic
  std::vector<Ports> ports_;                // by node
  std::vector<std::uint32_t> out_port_of_;  // by wire
  std::vector<std::uint32_t> ports_to_;     // by resource, then destination; empty unless all pairs have links
};

}  // namespace carousel::ringbus

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/queue_kind.h"
#include "core/types/ids.h"
#include "ringbus/topology/graph/channel_plan.h"

namespace carousel::ringbus {

/// Tells, before a run, whether the queues of a network can all be full at once and stay so
/// (docs/how-it-works/design.md, Deadlock and the end).
struct DeadlockVerdict {
  bool can_deadlock = false;
  std::string rule;  ///< the rule that protects the network, with its numbers; or what is missing
};

/// Everything a shape of network says about itself, as plain data. Each shape has one function that fills this in
/// (shapes.h); Topology derives its tables from it.
///
/// Nodes are the resources, from 0 on, and behind them the hubs.
struct TopologyPlan {
  /// A one-way link. At each of its two ends `direction` is the number of its port, unless packets are sent directly:
  /// then ports are counted in the order of the wires, or with a bus of their resources. Where packets are routed it is
  /// the lane that the link is for, and 0 of one for all.
  struct Wire {
    ResourceId from, to;
    std::uint16_t direction = 0;
    std::int64_t latency_cycles = 1;
    std::int64_t node_cycles = 0;      ///< that its first node takes before
    std::int64_t depth = 0;            ///< packets; 0: as topology.link says, also below
    std::int64_t bytes_per_cycle = 0;  ///< width
    std::int64_t credit_cycles = 0;    ///< that its last node takes to tell of a free place, besides the latency
    double mm = -1;                    ///< length along the axes of the die; negative: not known
    std::int64_t mhz = 0;              ///< of its clock; 0: that of the resources
    std::optional<QueueKind> queue{};  ///< of the native engine; absent: as topology.link says
    std::uint32_t places = 0;          ///< egress places before it; 0: as its first node has
  };

  /// A node that is no resource.
  enum class Hub : std::uint8_t {
    kBus,     ///< one medium for all: it moves one packet at a time, straight to its next stop
    kRouter,  ///< passes packets on to the port that `exits` names
    kRing,    ///< a ring whose stops have no queues, with a port for each of these
  };
  /// The way out of a node towards a resource.
  struct Exit {
    std::uint16_t port = 0;
    bool through = false;  ///< the next node sends a packet on as soon as its head has come
  };

  /// The ways over a ring whose stops have no queues.
  struct StopRing {
    bool both = false;                  ///< packets take the shorter way; else there is one direction
    std::vector<std::uint32_t> stops;   ///< nodes, in the order of the ring
    std::vector<std::uint32_t> places;  ///< by node: its place among these, or as many as there are
    std::vector<ResourceId> off;        ///< by place, then resource: the stop where packets for it leave the ring
  };

  /// By direction, then by resource: the node that comes next on the round of that direction. A packet keeps its
  /// direction all the way round. One direction at least. Lanes of a graph are directions.
  std::vector<std::vector<ResourceId>> successors;
  std::vector<Wire> wires;
  /// Packets are sent straight to their next stop, without passing other resources. The round then only says in which
  /// order a packet visits them.
  bool direct = false;
  /// Packets find their way from stop to stop by `exits`, by node, then direction and resource. Stops are in the order
  /// of the round; with `topology.visit: owners` those that own none of the members are left out. Ports are counted in
  /// the order of lanes, and then of the nodes at the other ends of their links.
  bool routed = false;
  std::vector<Exit> exits;  ///< nothing at rings, whose ways are theirs
  /// Every node has egress places for all packets there are, so that no link waits for another.
  bool room_for_all = false;
  std::vector<std::uint32_t> hub_places;  ///< egress places of hubs for each port; 0, or empty: room for all packets
  std::vector<Hub> hubs;
  std::vector<StopRing> rings;  ///< of the hubs of that kind, which are the last
  /// By resource: the packet process that issues the packets of its rays, itself for one of these, which has no rays.
  /// Empty: every resource issues packets, of whatever rays.
  std::vector<std::uint32_t> manager_of;
  /// Packets of its own that a resource may have under way in each direction.
  std::uint32_t packets_in_flight = 0;
  DeadlockVerdict verdict;
  /// Flits of a packet need not stay together: links are of one width, and no node stores packets whole.
  bool flits_apart = false;
  ChannelPlan channels;                     ///< only where packets are routed
  std::vector<std::uint32_t> claim_cycles;  ///< by node, as the key of the graph's nodes; likewise
  std::vector<std::int64_t> node_mhz;       ///< by node, its clock; 0, or empty: that of the resources
  /// By direction of a packet: the direction in which the acknowledgement of its delivery travels back to its source.
  /// Only where traffic runs and packets are not sent directly.
  std::vector<std::uint16_t> ack_directions;
};

}  // namespace carousel::ringbus

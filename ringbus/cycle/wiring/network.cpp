#include "ringbus/cycle/wiring/network.h"

#include <optional>
#include <utility>

#include "ringbus/cycle/parcels/shared_link.h"

namespace carousel::ringbus::cycle {

Network::Network(ChannelList& list, const Machine& machine, const LinkConfig& link, const FaultsConfig& faults,
                 std::int64_t contexts, const SharedWires& shared)
    : machine_(machine), faults_(faults), egress_places_(static_cast<std::size_t>(contexts) + 1) {
  const Topology& topology = machine.topology;
  const MessageKind packets =
      list.carry({"packets", "resources", "neighbours", "links", static_cast<std::uint64_t>(link.bytes_per_cycle)});
  std::optional<MessageKind> onwards;
  for (std::uint32_t i = 0; i < topology.wires().size(); ++i) {
    const Topology::Wire& wire = topology.wires()[i];
    const auto latency = static_cast<Cycle>(wire.latency_cycles);
    far_.emplace_back();
    if (const auto agent = shared.find(i); agent != shared.end()) {
      if (!onwards)
        onwards = list.carry({"packets on shared links", "near ends", "far ends", "links",
                              static_cast<std::uint64_t>(link.bytes_per_cycle)});
      wires_.push_back(std::make_unique<Wire>(list.at(packets, {wire.from.value, agent->second, 1})));
      far_.back() = std::make_unique<Wire>(
          list.at(*onwards, {agent->second, wire.to.value, SharedLink::far_latency(wire.latency_cycles)}));
    } else {
      wires_.push_back(std::make_unique<Wire>(list.at(packets, {wire.from.value, wire.to.value, latency})));
    }
  }
  for (std::uint32_t hub = 0; hub < topology.hubs().size(); ++hub) {
    NodePorts ports = ports_at(ResourceId(static_cast<std::uint32_t>(topology.resources()) + hub));
    hubs_.push_back(make_hub(hub, topology, machine.packets, std::move(ports.in), std::move(ports.out)));
  }
}

Network::NodePorts Network::ports_at(ResourceId node) const {
  const Topology& topology = machine_.topology;
  const auto latency = [&](std::uint32_t wire) { return static_cast<Cycle>(topology.wires()[wire].latency_cycles); };
  // On a ring, a resource has egress places for the packets in test and for one that passes meanwhile. At a hub, and
  // wherever packets are sent directly, there are places for all packets there are, as nothing else would keep circles
  // of links from closing.
  const bool hub = node.value >= topology.resources();
  std::size_t places = hub || topology.room_for_all() ? machine_.packets.size() : egress_places_;
  if (hub)
    if (const std::uint32_t given = topology.hub_places(node.value - topology.resources()); given > 0) places = given;
  NodePorts ports;
  // Where others share a link, their agent stands a cycle behind its near end.
  for (const std::uint32_t i : topology.ports(node).in) {
    const Topology::Wire& wire = topology.wires()[i];
    ports.in.push_back({&far(i), (far_[i] ? SharedLink::far_latency(wire.latency_cycles) : latency(i)) +
                                     static_cast<Cycle>(wire.credit_cycles)});
  }
  for (const std::uint32_t i : topology.ports(node).out) {
    const Topology::Wire& wire = topology.wires()[i];
    const Cycle away = (far_[i] ? Cycle{1} : latency(i)) + static_cast<Cycle>(wire.node_cycles);
    OutPort& out = ports.out.emplace_back(*wires_[i], away, static_cast<std::uint32_t>(wire.depth), places);
    if (faults_.links.any()) out.fail(LinkFaultTimer(faults_.links, faults_.seed, i, away));
  }
  return ports;
}

}  // namespace carousel::ringbus::cycle

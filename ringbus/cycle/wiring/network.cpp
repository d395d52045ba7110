#include "ringbus/cycle/wiring/network.h"

#include <optional>
#include <utility>

#include "ringbus/cycle/parcels/shared_link.h"

namespace carousel::ringbus::cycle {

Network::Network(ChannelList& list, const Machine& machine, const TopologyConfig& config, const FaultsConfig& faults,
                 std::vector<std::int64_t> contexts, MachineClocks clocks, const SharedWires& shared)
    : machine_(machine), faults_(faults), contexts_(std::move(contexts)), clocks_(clocks) {
  const Topology& topology = machine.topology;
  const MessageKind packets = list.carry(
      {"packets", "resources", "neighbours", "links", static_cast<std::uint64_t>(config.link.bytes_per_cycle)});
  std::optional<MessageKind> onwards;
  for (std::uint32_t i = 0; i < topology.wires().size(); ++i) {
    const Topology::Wire& wire = topology.wires()[i];
    const auto latency = static_cast<Cycle>(wire.latency_cycles);
    const ClockRatio to_receiver = clocks_.between(wire.mhz, topology.mhz(wire.to)),
                     to_sender = clocks_.between(wire.mhz, topology.mhz(wire.from));
    far_.emplace_back();
    if (const auto agent = shared.find(i); agent != shared.end()) {
      if (!onwards)
        onwards = list.carry({"packets on shared links", "near ends", "far ends", "links",
                              static_cast<std::uint64_t>(config.link.bytes_per_cycle)});
      wires_.push_back(std::make_unique<Wire>(list.at(packets, {wire.from.value, agent->second, 1})));
      wires_.back()->packets.cross({}, to_sender);
      far_.back() = std::make_unique<Wire>(
          list.at(*onwards, {agent->second, wire.to.value, SharedLink::far_latency(wire.latency_cycles)}));
      far_.back()->packets.cross(to_receiver, {});
    } else {
      wires_.push_back(std::make_unique<Wire>(list.at(packets, {wire.from.value, wire.to.value, latency})));
      wires_.back()->packets.cross(to_receiver, to_sender);
    }
  }
  for (std::uint32_t hub = 0; hub < topology.hubs().size(); ++hub) {
    const ResourceId node(static_cast<std::uint32_t>(topology.resources()) + hub);
    NodePorts ports = ports_at(node);
    if (topology.hubs()[hub] == Topology::Hub::kRing) {
      auto ring = std::make_unique<RingHub>(node, config, topology, std::move(ports.in), std::move(ports.out));
      rings_.push_back(ring.get());
      hubs_.push_back(std::move(ring));
    } else {
      hubs_.push_back(make_hub(hub, topology, machine.packets, std::move(ports.in), std::move(ports.out)));
    }
    hubs_.back()->tell_time(clocks_.from_core(topology.mhz(node)));
  }
}

Network::NodePorts Network::ports_at(ResourceId node) const {
  const Topology& topology = machine_.topology;
  const auto latency = [&](std::uint32_t wire) { return static_cast<Cycle>(topology.wires()[wire].latency_cycles); };
  // On a ring, a resource has egress places for the packets in test and for one that passes meanwhile. At a hub, and
  // wherever packets are sent directly, there are places for all packets there are, as nothing else would keep circles
  // of links from closing.
  const bool hub = node.value >= topology.resources();
  std::size_t places =
      hub || topology.room_for_all() ? machine_.packets.size() : static_cast<std::size_t>(contexts_[node.value]) + 1;
  if (hub)
    if (const std::uint32_t given = topology.hub_places(node.value - topology.resources()); given > 0) places = given;
  NodePorts ports;
  // Where others share a link, their agent stands a cycle behind its near end.
  for (const std::uint32_t i : topology.ports(node).in) {
    const Topology::Wire& wire = topology.wires()[i];
    const auto credit = static_cast<Cycle>(wire.credit_cycles);
    const Cycle back = far_[i] ? SharedLink::far_latency(wire.latency_cycles) : latency(i);
    if (wire.mhz != topology.mhz(node)) {
      const FarClock far_clock{clocks_.between(topology.mhz(node), wire.mhz), credit};
      ports.in.push_back({&far(i), back, std::make_shared<const FarClock>(far_clock)});
      continue;
    }
    ports.in.push_back({&far(i), back + credit, nullptr});
  }
  for (const std::uint32_t i : topology.ports(node).out) {
    const Topology::Wire& wire = topology.wires()[i];
    const bool crosses = wire.mhz != topology.mhz(node);
    const auto node_cycles = static_cast<Cycle>(wire.node_cycles);
    const Cycle away = (far_[i] ? Cycle{1} : latency(i)) + (crosses ? 0 : node_cycles);
    OutPort& out = ports.out.emplace_back(*wires_[i], away, static_cast<std::uint32_t>(wire.depth),
                                          wire.places > 0 ? wire.places : places);
    if (crosses) out.cross(clocks_.between(topology.mhz(node), wire.mhz), node_cycles);
    if (faults_.links.any()) out.fail(LinkFaultTimer(faults_.links, faults_.seed, i, away, crossings(wire, away)));
  }
  return ports;
}

Cycle Network::crossings(const Topology::Wire& wire, Cycle latency) const {
  const auto there_and_back = [&](ResourceId end, Cycle at) {
    const std::int64_t mhz = machine_.topology.mhz(end);
    return clocks_.between(mhz, wire.mhz).enter(clocks_.between(wire.mhz, mhz).enter(at));
  };
  return there_and_back(wire.from, there_and_back(wire.to, latency) + latency) - 2 * latency;
}

}  // namespace carousel::ringbus::cycle

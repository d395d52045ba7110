#include "ringbus/topology/wire_length.h"

#include <algorithm>
#include <cmath>

#include "core/config/graph/ring.h"
#include "ringbus/topology/graph_facts.h"

namespace carousel::ringbus {

namespace {

/// The first resource with a link to or from a router; 0 if there is none.
std::uint32_t beside(const Topology& topology, std::uint32_t router) {
  std::uint32_t first = static_cast<std::uint32_t>(topology.resources());
  const Topology::Ports& ports = topology.ports(ResourceId(router));
  for (const std::uint32_t wire : ports.in) first = std::min(first, topology.wires()[wire].from.value);
  for (const std::uint32_t wire : ports.out) first = std::min(first, topology.wires()[wire].to.value);
  return first < topology.resources() ? first : 0;
}

}  // namespace

double place_distance(std::uint32_t resources, std::uint32_t from, std::uint32_t to) {
  const std::uint32_t apart = from > to ? from - to : to - from;
  if (apart <= 1 || apart == resources - 1) return 1;
  const auto width = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(resources))));
  const auto column = [&](std::uint32_t at) {
    const std::uint32_t along = at % width;
    return static_cast<double>((at / width) % 2 == 0 ? along : width - 1 - along);
  };
  return std::abs(column(from) - column(to)) +
         std::abs(static_cast<double>(from / width) - static_cast<double>(to / width));
}

namespace {

/// In links between neighbours.
double links_long(const Topology& topology, const Topology::Wire& wire) {
  const auto resources = static_cast<std::uint32_t>(topology.resources());
  if (topology.broadcasts()) return wire.to.value >= resources ? static_cast<double>(resources) : 0.0;
  const auto place = [&](std::uint32_t node) { return node < resources ? node : beside(topology, node); };
  return place_distance(resources, place(wire.from.value), place(wire.to.value));
}

}  // namespace

double wire_length(const Topology& topology, const Topology::Wire& wire, double link_mm) {
  return wire.mm >= 0 ? wire.mm : link_mm * links_long(topology, wire);
}

std::vector<StopRingWire> stop_ring_wires(const TopologyConfig& config, double between) {
  std::vector<StopRingWire> out;
  if (!config::stop_ring_entry(config)) return out;
  const config::Graph graph = draw_checked(config);
  for (const config::StopRing& ring : config::stop_rings(config, graph))
    for (std::size_t i = ring.first; i < ring.first + ring.links(); ++i) {
      const config::Graph::Link& link = graph.links[i];
      const bool placed = graph.nodes[link.from].at.given && graph.nodes[link.to].at.given;
      const bool resources = link.from < graph.resources && link.to < graph.resources;
      const double mm = placed      ? link_mm(graph, link)
                        : resources ? between * place_distance(graph.resources, link.from, link.to)
                                    : between;
      out.push_back({mm, link.bytes_per_cycle});
    }
  return out;
}

double wire_lengths(const Topology& topology, std::int64_t bytes_per_cycle, double link_mm) {
  if (topology.broadcasts() && topology.wires().front().mm < 0)
    return link_mm * static_cast<double>(topology.resources());
  double sum = 0;
  for (const Topology::Wire& wire : topology.wires())
    sum += wire_length(topology, wire, link_mm) * static_cast<double>(wire.bytes_per_cycle) /
           static_cast<double>(bytes_per_cycle);
  return sum;
}

}  // namespace carousel::ringbus

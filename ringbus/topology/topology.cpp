#include "ringbus/topology/topology.h"

#include <algorithm>
#include <utility>

#include "ringbus/topology/shapes.h"

namespace carousel::ringbus {

Topology::Topology(const TopologyConfig& config) : Topology(config, plan_topology(config)) {}

Topology::Topology(const TopologyConfig& config, TopologyPlan plan)
    : plan_(std::move(plan)),
      properties_(properties_of(config)),
      resources_(static_cast<std::uint32_t>(config.resources)),
      visit_all_(config.visit == Visit::kAll),
      skips_ahead_(plan_.routed ? !visit_all_ : plan_.direct && (!visit_all_ || broadcasts())),
      has_widths_(
          std::ranges::any_of(plan_.wires,
                              [&](const Wire& wire) { return wire.bytes_per_cycle != config.link.bytes_per_cycle; }) ||
          !plan_.rings.empty()),  // which send packets on flit by flit
      ports_(resources_ + plan_.hubs.size()) {
  for (const std::vector<ResourceId>& round : plan_.successors)
    successors_.insert(successors_.end(), round.begin(), round.end());
  number_ports();
  if (properties_.carries_traffic && !plan_.routed && plan_.hubs.empty()) number_positions();
}

void Topology::number_ports() {
  const auto put = [this](std::vector<std::uint32_t>& ports, std::uint32_t wire) {
    const std::size_t at = plan_.direct || plan_.routed ? ports.size() : plan_.wires[wire].direction;
    if (ports.size() <= at) ports.resize(at + 1);
    ports[at] = wire;
  };
  for (std::uint32_t i = 0; i < plan_.wires.size(); ++i) {
    put(ports_[plan_.wires[i].from.value].out, i);
    put(ports_[plan_.wires[i].to.value].in, i);
  }
  if (plan_.routed || broadcasts())
    for (Ports& ports : ports_) {
      const auto sort = [&](std::vector<std::uint32_t>& some, ResourceId Wire::*end) {
        std::ranges::sort(some, {}, [&](std::uint32_t i) {
          return std::pair(plan_.wires[i].direction, (plan_.wires[i].*end).value);
        });
      };
      sort(ports.in, &Wire::from);
      sort(ports.out, &Wire::to);
    }
  out_port_of_.resize(plan_.wires.size());
  for (const Ports& ports : ports_)
    for (std::uint32_t port = 0; port < ports.out.size(); ++port) out_port_of_[ports.out[port]] = port;
  if (!plan_.direct || !plan_.hubs.empty()) return;
  ports_to_.resize(std::size_t{resources_} * resources_);
  for (std::uint32_t r = 0; r < resources_; ++r)
    for (std::uint32_t port = 0; port < ports_[r].out.size(); ++port)
      ports_to_[r * std::size_t{resources_} + plan_.wires[ports_[r].out[port]].to.value] = port;
}

void Topology::number_positions() {
  position_.resize(successors_.size());
  for (std::size_t d = 0; d < directions(); ++d) {
    ResourceId at(0);
    for (std::uint32_t links = 0; links < resources_; ++links, at = plan_.successors[d][at.value])
      position_[d * resources_ + at.value] = links;
  }
}

std::uint16_t Topology::links_between(std::size_t direction, ResourceId from, ResourceId to) const {
  if (plan_.direct) return from != to;
  const std::uint32_t* position = position_.data() + direction * std::size_t{resources_};
  const std::uint32_t ahead = position[to.value] + resources_ - position[from.value];
  return static_cast<std::uint16_t>(ahead >= resources_ ? ahead - resources_ : ahead);
}

Topology::Route Topology::routed_way(ResourceId from, ResourceId to) const {
  Route way;
  for (ResourceId at = from; at != to; ++way.hops) {
    const ResourceId before = at;
    at = plan_.wires[ports_[at.value].out[exit(at, to).port]].to;
    const TopologyPlan::StopRing* const over = ring(at);
    if (over == nullptr) continue;
    at = leaves_at(*over, before, to);
    const std::uint32_t stops = static_cast<std::uint32_t>(over->stops.size());
    const std::uint32_t ahead = (over->places[at.value] + stops - over->places[before.value]) % stops;
    way.hops += static_cast<std::uint16_t>(1 + (over->both ? std::min(ahead, stops - ahead) : ahead));
  }
  return way;
}

Topology::Route Topology::route(ResourceId from, ResourceId to, std::uint32_t random) const {
  if (plan_.routed) return routed_way(from, to);
  Route best{0, links_between(0, from, to)};
  std::uint32_t equal = 1;
  const auto directions = static_cast<std::uint16_t>(this->directions());
  for (std::uint16_t d = 1; d < directions; ++d) {
    const std::uint16_t hops = links_between(d, from, to);
    if (hops < best.hops) {
      best = {d, hops};
      equal = 1;
    } else if (hops == best.hops) {
      ++equal;
    }
  }
  if (equal == 1) return best;
  for (std::uint32_t others = random % equal; others > 0;) {
    ++best.direction;
    if (links_between(best.direction, from, to) == best.hops) --others;
  }
  return best;
}

std::uint32_t Topology::hops(const Packet& packet) const {
  if (resources_ == 1) return 0;
  // All hear a broadcast at once, so it is not made if no other resource has rays of it.
  if ((visit_all_ && !broadcasts()) || packet.kind == PacketKind::kRays) return resources_;
  if (packet.kind == PacketKind::kMemberships) return packet.home == packet.owner ? 0 : resources_;
  for (std::size_t i = 0; i < packet.owners.size(); ++i) {
    std::uint64_t others = packet.owners[i];
    if (packet.owner.value / 64 == i) others &= ~(std::uint64_t{1} << (packet.owner.value % 64));
    if (others != 0) return resources_;
  }
  return 0;
}

}  // namespace carousel::ringbus

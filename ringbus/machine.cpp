#include "ringbus/machine.h"

#include "ringbus/resource.h"

namespace carousel::ringbus {

namespace {

std::vector<std::unique_ptr<RayStore>> make_stores(const Config& config) {
  std::vector<std::unique_ptr<RayStore>> stores;
  for (std::uint32_t r = 0; r < static_cast<std::uint32_t>(config.topology.resources); ++r)
    stores.push_back(std::make_unique<RayStore>(ResourceId(r), static_cast<std::uint32_t>(config.rays.slots_per_resource)));
  return stores;
}

}  // namespace

Machine::Machine(const Config& c, const accel::Accel& a)
    : config(c), accel(a), topology(c.topology), packets_per_direction(packets_in_flight(c.topology)),
      stores(make_stores(c)), control(c, stores, Resource::initial_tests(c, a)) {
  const std::size_t words = (topology.resources() + 63) / 64;
  const std::size_t rays = static_cast<std::size_t>(c.packets.rays);
  packets.resize(topology.resources() * topology.directions() * packets_per_direction);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    Packet& p = packets[i];
    p.owner = ResourceId(static_cast<std::uint32_t>(i / (topology.directions() * packets_per_direction)));
    p.direction = static_cast<std::uint16_t>(i / packets_per_direction % topology.directions());
    p.members.reserve(rays);
    p.owners.resize(words);
    if (c.collections.traversal == Traversal::kOrdered) p.next.reserve(rays);
  }
  for (const Topology::Wire& wire : topology.wires())
    links.push_back(make_link(c.topology.link.queue, static_cast<std::size_t>(c.topology.link.depth), wire.from, wire.to));
}

}  // namespace carousel::ringbus

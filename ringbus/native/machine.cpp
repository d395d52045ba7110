#include "ringbus/native/machine.h"

#include "ringbus/protocol/packet_pool.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

Machine::Machine(const Config& c, const accel::Accel& a, float scene_size)
    : config(c),
      accel(a),
      topology(c.topology),
      packets_per_direction(topology.packets_in_flight()),
      packets(make_packets(c, topology, packets_per_direction)),
      stores(make_ray_stores(c.topology.resources, c.rays.slots_per_resource, c.bundles)),
      control(ray_control_settings(c, Resource::initial_tests(resource_settings(c, scene_size), a), scene_size),
              stores) {
  // One resource sends on a wire and one receives, and one thread at a time plays a resource.
  require_parties(c.topology.link.queue, "topology.link.queue", Parties::kOne, Parties::kOne);
  for (const Topology::Wire& wire : topology.wires())
    links.push_back(make_link(c, links.size(), wire.from, wire.to, packets));
}

}  // namespace carousel::ringbus

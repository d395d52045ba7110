#include "ringbus/cycle/machine/cycle_machine.h"

#include <algorithm>

#include "ringbus/resource/resource.h"

namespace carousel::ringbus::cycle {

CycleMachine::CycleMachine(const Config& c, const accel::Accel& a, float scene_size)
    : config(c),
      accel(a),
      topology(c.topology),
      memory(a, c.accuracy),
      packets(make_packets(c, topology, packets_per_direction())),
      stores(make_ray_stores(c.topology.resources, c.rays.slots_per_resource, c.bundles)),
      control(ray_control_settings(c, Resource::initial_tests(resource_settings(c, scene_size), a), scene_size),
              stores) {}

std::uint32_t CycleMachine::packets_per_direction() const {
  if (!topology.has_packets()) return 0;
  // What never travels needs no credit: one in each context, and those whose shapes are being fetched.
  if (stays()) return static_cast<std::uint32_t>(config.testers.contexts + 1 + config.memory.fetch_ahead);
  return topology.packets_in_flight();
}

Cycle control_latency(const Config& config) {
  return std::max<Cycle>(1, static_cast<Cycle>(config.topology.link.latency_cycles));
}

}  // namespace carousel::ringbus::cycle

#pragma once

#include <cstdint>
#include <vector>

#include "core/config/config.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_source.h"

namespace carousel::ringbus {

/// The packets that one source creates.
struct Created {
  std::vector<std::uint64_t> times;
  std::vector<std::uint32_t> to;
};
inline Created created_by(const Config& c, std::uint32_t resource) {
  const auto seed = static_cast<std::uint64_t>(c.image.seed);
  const auto resources = static_cast<std::size_t>(c.topology.resources);
  const cycle::TrafficEnds ends = cycle::traffic_ends(c.topology, c.workload.traffic);
  const cycle::TrafficPlan plan(c.workload.traffic, seed, resources, ends);
  cycle::TrafficSource source(c.workload.traffic, seed, resources, ends, ResourceId(resource), plan.gap);
  Created out;
  for (std::uint64_t i = 0; i < plan.packets[resource]; ++i) {
    source.advance();
    out.times.push_back(source.created());
    out.to.push_back(source.destination().value);
  }
  return out;
}

}  // namespace carousel::ringbus

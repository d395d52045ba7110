#pragma once

#include <cstddef>
#include <cstdint>

#include "ringbus/cycle/fabric/token.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// The next link of a packet's way to its stop.
struct Course {
  std::size_t port = 0;
  bool through = false;  ///< the next node sends it on as soon as its head has come
};

/// The course of a packet that is at `node`, another one than its stop. Where links differ in width it fills in for how
/// long the packet occupies this one.
inline Course course_of(Token& token, const Topology& topology, ResourceId node) {
  const TopologyPlan::Exit exit = topology.exit(node, ResourceId(token.stop), token.lane);
  if (topology.has_widths()) [[unlikely]] {
    const Topology::Wire& wire = topology.wires()[topology.ports(node).out[exit.port]];
    const auto width = static_cast<std::uint32_t>(wire.bytes_per_cycle);
    token.link_cycles = (token.size_bytes + width - 1) / width;
  }
  return {exit.port, exit.through};
}

}  // namespace carousel::ringbus::cycle

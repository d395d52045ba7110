#pragma once

#include <cstddef>
#include <cstdint>

namespace carousel::ringbus::cycle {

/// The numbers of a machine's agents: the nodes of its network (resources, then hubs), the L2s, the resources' own
/// caches if they have any, memory, ray control with shading, and the parts that declare themselves.
struct AgentNumbers {
  std::uint32_t nodes = 0, caches = 0, own_caches = 0;
  std::uint32_t shared_by = 1;  ///< resources of an L2

  std::uint32_t cache(std::size_t number) const { return nodes + static_cast<std::uint32_t>(number); }
  std::uint32_t own_cache(std::size_t resource) const { return nodes + caches + static_cast<std::uint32_t>(resource); }
  std::uint32_t memory() const { return nodes + caches + own_caches; }
  std::uint32_t shading() const { return memory() + 1; }
  /// Those parts are numbered from here: the first one's by L2, then the next one's.
  std::uint32_t parts() const { return shading() + 1; }
  /// The L2 behind a resource, and the cache that the resource asks.
  std::uint32_t cache_behind(std::size_t resource) const { return cache(resource / shared_by); }
  std::uint32_t nearest_cache(std::size_t resource) const {
    return own_caches > 0 ? own_cache(resource) : cache_behind(resource);
  }
};

}  // namespace carousel::ringbus::cycle

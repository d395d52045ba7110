#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carousel::ringbus::cycle {

/// The numbers of a machine's agents: the nodes of its network (resources, then hubs), the L2s, the resources' own
/// caches if they have any, the memories, ray control with shading, where parts are drawn the relays of all nodes of
/// the graph and the links that packets share with others, and the parts that declare themselves.
struct AgentNumbers {
  std::uint32_t nodes = 0, caches = 0, own_caches = 0;
  std::uint32_t shared_by = 1;  ///< resources of an L2
  std::uint32_t memories = 1, relays = 0, shared_links = 0;
  /// Which parts are drawn: what is sent to them goes to the relay of its sender.
  bool caches_drawn = false, memories_drawn = false, new_rays_drawn = false, completed_drawn = false;
  std::uint32_t first_cache_node = 0;       ///< of the graph
  std::vector<std::uint32_t> pool_nodes{};  ///< of the graph, by resource: where its pool of workers is drawn

  std::uint32_t cache(std::size_t number) const { return nodes + static_cast<std::uint32_t>(number); }
  std::uint32_t own_cache(std::size_t resource) const { return nodes + caches + static_cast<std::uint32_t>(resource); }
  std::uint32_t memory(std::size_t number = 0) const {
    return nodes + caches + own_caches + static_cast<std::uint32_t>(number);
  }
  std::uint32_t shading() const { return memory(memories); }
  std::uint32_t relay(std::size_t node) const { return shading() + 1 + static_cast<std::uint32_t>(node); }
  std::uint32_t shared_link(std::size_t number) const { return relay(relays) + static_cast<std::uint32_t>(number); }
  /// Those parts are numbered from here: the first one's by L2, then the next one's.
  std::uint32_t parts() const { return shared_link(shared_links); }
  /// The L2 behind a resource, and the cache that the resource asks.
  std::uint32_t cache_behind(std::size_t resource) const {
    return caches_drawn ? relay(resource) : cache(resource / shared_by);
  }
  std::uint32_t nearest_cache(std::size_t resource) const {
    return own_caches > 0 ? own_cache(resource) : cache_behind(resource);
  }
  /// Resources ask their L2s over links, without caches of their own between.
  bool asks_over_links() const { return caches_drawn && own_caches == 0; }
  /// What an L2 asks.
  std::uint32_t memory_behind(std::size_t cache) const {
    return memories_drawn ? relay(first_cache_node + cache) : memory();
  }
};

}  // namespace carousel::ringbus::cycle

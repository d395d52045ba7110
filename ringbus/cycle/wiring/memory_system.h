#pragma once

#include <memory>
#include <vector>

#include "core/config/config.h"
#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/results/class_use.h"
#include "ringbus/results/ray_data_use.h"
#include "ringbus/time/wakeup_table.h"

namespace carousel::ringbus::cycle {

/// The caches, each shared by some neighbouring resources, and the memory behind them.
class MemorySystem {
 public:
  /// `clients` by resource. `shading`: by L2, or none.
  MemorySystem(const Config& config, const std::vector<ShapeCache::Client>& clients,
               const std::vector<ShapeCache::Client>& shading = {});
  static std::size_t shared_caches(const Config& config) {
    return static_cast<std::size_t>((config.topology.resources - 1) / config.memory.shared_by + 1);
  }

  const std::vector<std::unique_ptr<ShapeCache>>& caches() const { return caches_; }
  /// The resources' own, by resource; empty if they have none.
  const std::vector<std::unique_ptr<ShapeCache>>& own_caches() const { return own_; }
  /// The cache that a resource asks.
  const ShapeCache& cache_of(std::size_t resource) const {
    return own_.empty() ? *caches_[resource / shared_by_] : *own_[resource];
  }
  MemoryAgent& memory() { return *memory_; }
  const MemoryAgent& memory() const { return *memory_; }
  /// Before the start. A machine with other caches than those that held the lines starts cold.
  void warm(const WarmCaches& from);
  /// Calls `body` with the channels to memory and back, cache by cache.
  template <class Body>
  void for_each_channel(const Body& body) const {
    for (std::size_t c = 0; c < caches_.size(); ++c) body(*to_memory_[c], *from_memory_[c]);
  }
  /// Calls `body` with the channels from each resource's own cache down and back.
  template <class Body>
  void for_each_own_channel(const Body& body) const {
    for (std::size_t r = 0; r < own_.size(); ++r) body(*own_down_[r], *own_up_[r]);
  }
  /// The run was over at `end`: caches write back all that they hold for memory.
  CacheDrain drain(Cycle end);
  /// Announces arrivals between caches and memory.
  void connect(WakeupTable& wakeups) const;
  /// The least latency of any channel to a cache or to memory.
  static Cycle least_latency(const MemoryConfig& config);

 private:
  std::size_t shared_by_;
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> to_memory_, from_memory_;  // by cache
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> own_down_, own_up_;        // by resource
  std::vector<std::unique_ptr<ShapeCache>> caches_, own_;
  std::unique_ptr<MemoryAgent> memory_;
};

}  // namespace carousel::ringbus::cycle

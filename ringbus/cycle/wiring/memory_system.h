#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/statistics/memory_counts.h"
#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/cycle/wiring/agent_numbers.h"
#include "ringbus/results/class_use.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// The caches, each shared by some neighbouring resources, and the memory behind them.
class MemorySystem {
 public:
  /// `clients` by resource. `others`: by L2, those that ask it beside resources. `clock_mhz`: engine.clock_mhz. With
  /// own caches there are kinds of messages for them.
  MemorySystem(ChannelList& list, const MemoryKinds& kinds, const std::optional<OwnCacheKinds>& own_kinds,
               const AgentNumbers& agents, const MemoryConfig& config, std::int64_t clock_mhz,
               const std::vector<ShapeCache::Client>& clients,
               const std::vector<std::vector<ShapeCache::Client>>& others);
  static std::size_t shared_caches(const MemoryConfig& config, std::int64_t resources) {
    return static_cast<std::size_t>((resources - 1) / config.shared_by + 1);
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
  /// The run was over at `end`: caches write back all that they hold for memory.
  CacheDrain drain(Cycle end);
  /// Fills in the row of the lines that the caches have written to memory.
  void count_written(ByteRow& row) const;

 private:
  std::size_t shared_by_;
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> to_memory_, from_memory_;  // by cache
  std::vector<std::unique_ptr<Channel<std::uint64_t>>> own_down_, own_up_;        // by resource
  std::vector<std::unique_ptr<ShapeCache>> caches_, own_;
  std::unique_ptr<MemoryAgent> memory_;
};

}  // namespace carousel::ringbus::cycle

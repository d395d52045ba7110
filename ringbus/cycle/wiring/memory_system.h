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
#include "ringbus/time/machine_clocks.h"

namespace carousel::ringbus::cycle {

/// The askers of caches and memories that are drawn: the far ends of the links' channels.
struct DrawnAskers {
  struct AtCache {
    std::vector<ShapeCache::Client> resources;
    std::vector<ShapeCache::OwnCache> own_caches;
  };
  struct AtMemory {
    std::int64_t mhz = 0;  ///< of its clock; 0: that of the resources
    std::vector<MemoryAgent::Client> askers{};
  };
  std::vector<AtCache> caches;
  std::vector<AtMemory> memories;  ///< empty: one memory, beside the links
};

/// The caches, each shared by some neighbouring resources, and the memory behind them; or as they are drawn.
class MemorySystem {
 public:
  /// `clients` by resource, as `own_configs`, which their own caches follow. `others`: by L2, those that ask it beside
  /// resources. With own caches there are kinds of messages for them.
  MemorySystem(ChannelList& list, const MemoryKinds& kinds, const std::optional<OwnCacheKinds>& own_kinds,
               const AgentNumbers& agents, const MemoryConfig& config, const std::vector<MemoryConfig>& own_configs,
               const MachineClocks& clocks, const std::vector<ShapeCache::Client>& clients,
               const std::vector<std::vector<ShapeCache::Client>>& others, const DrawnAskers* drawn = nullptr);
  static std::size_t shared_caches(const MemoryConfig& config, std::int64_t resources) {
    return static_cast<std::size_t>((resources - 1) / config.shared_by + 1);
  }

  const std::vector<std::unique_ptr<ShapeCache>>& caches() const { return caches_; }
  /// The resources' own, by resource; empty if they have none.
  const std::vector<std::unique_ptr<ShapeCache>>& own_caches() const { return own_; }
  const std::vector<std::unique_ptr<MemoryAgent>>& memories() const { return memories_; }
  /// Of all memories together.
  MemoryCounts counts() const;
  double peak_bytes_per_cycle() const;
  /// Null unless there are banks. Call it after the memories are closed.
  std::optional<DramUse> dram_use(Cycle end) const;
  /// The near ends of the channels of the L2s to memory, and of the resources' own caches to their L2s.
  std::vector<MemoryAgent::Client> to_memory() const { return ends(to_memory_, from_memory_); }
  std::vector<MemoryAgent::Client> own_to_l2() const { return ends(own_down_, own_up_); }
  /// Before the start. A machine with other caches than those that held the lines starts cold.
  void warm(const WarmCaches& from);
  /// The run was over at `end`: caches write back all that they hold for memory. `between`: agents over which that
  /// travels, none of which has done anything since `quiet_from`.
  CacheDrain drain(Cycle end, const std::vector<Agent*>& between, Cycle quiet_from);
  /// Fills in the row of the lines that the caches have written to memory.
  void count_written(ByteRow& row) const;

 private:
  using Channels = std::vector<std::unique_ptr<Channel<std::uint64_t>>>;
  static std::vector<MemoryAgent::Client> ends(const Channels& down, const Channels& up);
  void add_cache(ChannelList& list, const MemoryKinds& kinds, const AgentNumbers& agents, const MemoryConfig& config,
                 std::vector<ShapeCache::OwnCache> own_caches, std::vector<ShapeCache::Client> askers);

  std::size_t shared_by_;
  Channels to_memory_, from_memory_;  // by cache
  Channels own_down_, own_up_;        // by resource
  std::vector<std::unique_ptr<ShapeCache>> caches_, own_;
  std::vector<std::unique_ptr<MemoryAgent>> memories_;
};

}  // namespace carousel::ringbus::cycle

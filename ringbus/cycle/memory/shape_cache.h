#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/config/config.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/memory/line_cache.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/cycle/time/channel.h"

namespace carousel::ringbus::cycle {

/// The L2 that some resources share: looks up a line a cycle, in the order in which requests arrive (at one time:
/// of the resources). A line that is on its way from memory is requested once. The cache is read only, so nothing is
/// written back.
class ShapeCache final : public Agent {
 public:
  struct Client {
    Channel<FetchRequest>* requests = nullptr;
    Channel<FetchAnswer>* answers = nullptr;
  };
  /// Half of the latency is spent on the way in, half on the way out, at least a cycle each.
  static Cycle request_latency(const MemoryConfig& config);
  static Cycle answer_latency(const MemoryConfig& config);

  ShapeCache(const MemoryConfig& config, std::vector<Client> clients, Channel<std::uint64_t>& to_memory,
             Channel<std::uint64_t>& from_memory);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  std::string describe() const override;

  using Statistics = CacheCounts;
  const Statistics& statistics() const { return statistics_; }

 private:
  struct Pending {
    std::size_t client = 0;
    std::uint32_t tag = 0, lines_missing = 0;
    Cycle ready = 0;
  };

  void look_up(std::size_t client, const FetchRequest& request, Cycle now);
  void fill(std::uint64_t line, Cycle now);
  void answer(const Pending& pending);

  Cycle answer_latency_, memory_latency_;
  LineCache cache_;
  std::vector<Client> clients_;
  std::vector<Cycle> last_answer_;  // answers of a client go out in order of time
  Channel<std::uint64_t>&to_memory_, &from_memory_;
  Cycle port_free_ = 0;
  std::vector<Pending> pending_;
  std::vector<std::uint32_t> free_pending_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> missing_;  // line to pending requests
  Statistics statistics_;
};

}  // namespace carousel::ringbus::cycle

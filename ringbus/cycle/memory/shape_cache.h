#pragma once

#include <cstdint>
#include <queue>
#include <span>
#include <vector>

#include "core/config/config.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/memory/line_cache.h"
#include "ringbus/cycle/memory/missing_lines.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/cycle/time/channel.h"

namespace carousel::ringbus::cycle {

/// The L2 that some resources share: looks up so many lines a cycle, in the order in which requests arrive (at one
/// time: of the resources). A line that is on its way from memory is requested once. Lines that a resource writes,
/// spilled collection entries, go through to memory: one that is here is brought up to date, and others take no
/// room. An answer leaves when the last line of its request is there, also before those of earlier requests.
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

  /// Holds part of these lines from the start.
  void warm(std::span<const std::uint64_t> lines, double part);
  std::vector<std::uint64_t> lines() const { return cache_.lines(); }

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override;

  using Statistics = CacheCounts;
  const Statistics& statistics() const { return statistics_; }

 private:
  struct Pending {
    std::uint32_t client = 0, tag = 0, lines_missing = 0;
    Cycle ready = 0;
  };
  /// An answer that leaves at `ready`. Of answers that leave at one time the one that was complete first goes first.
  struct Answer {
    Cycle ready = 0;
    std::uint64_t turn = 0;
    std::uint32_t client = 0, tag = 0;
    bool operator>(const Answer& o) const { return ready != o.ready ? ready > o.ready : turn > o.turn; }
  };

  void write(const FetchRequest& request, Cycle now);
  void look_up(std::uint32_t client, const FetchRequest& request, Cycle now);
  void fill(std::uint64_t line, Cycle now);
  Cycle take_port(Cycle now);
  void complete(std::uint32_t index);

  Cycle answer_latency_, memory_latency_;
  LineCache cache_;
  std::vector<Client> clients_;
  Channel<std::uint64_t>&to_memory_, &from_memory_;
  std::uint64_t port_lines_;     // a cycle
  std::uint64_t looked_up_ = 0;  // the port is taken up to this line of time, of which a cycle has port_lines_
  Cycle port_busy_until_ = 0;    // the first cycle after the last in which a line was looked up
  std::priority_queue<Answer, std::vector<Answer>, std::greater<>> answers_;
  std::uint64_t next_turn_ = 0;
  std::vector<Pending> pending_;
  std::vector<std::uint32_t> free_pending_;
  MissingLines missing_;  // with pending requests
  Cycle next_ = 0;        // next(), at the end of the last run()
  Statistics statistics_;
};

}  // namespace carousel::ringbus::cycle

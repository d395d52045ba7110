#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "core/config/config.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shapes/line_cache.h"
#include "ringbus/cycle/shapes/missing_lines.h"
#include "ringbus/cycle/shapes/strip_walks.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// The L2 that some resources share. Its banks hold the lines in turn, and each looks up so many a cycle, in the order
/// in which requests arrive (at one time: of the resources). A line that is on its way from memory is requested once. A
/// bank that may have no further line on its way (`memory.l2_mshrs`) stops at the next that has to be fetched. An
/// answer leaves when the last line of its request is there, also before those of earlier requests.
///
/// Lines that a resource writes are spilled collection entries. With `memory.l2_write: through` they go on to memory:
/// one that is here is brought up to date, and others take no room. With `back` they stay here until they are replaced;
/// one of which only a part is written is fetched first.
///
/// A resource's own cache (`memory.l1_kib`) is one too, with an L2 in the place of memory: own_cache() names its
/// parameters. It asks for lines one by one, and what is written goes through.
///
/// With `memory.l2_sector_bytes` "line" here means a sector (see fetched_bytes()), but for replacement.
class ShapeCache final : public Agent {
 public:
  struct Client {
    Channel<FetchRequest>* requests = nullptr;
    Channel<FetchAnswer>* answers = nullptr;
    Channel<PushedShapes>* pushed = nullptr;  ///< with `memory.fetch: multicast`
  };
  /// The end of an own cache's channels.
  struct OwnCache {
    Channel<std::uint64_t>* requests = nullptr;  ///< line numbers, with kWriteLine and kWholeLine
    Channel<std::uint64_t>* answers = nullptr;
  };
  /// The parameters of a resource's own cache, in the place of those of the L2.
  static MemoryConfig own_cache(const MemoryConfig& config);
  /// The parameters of the cache that a resource asks.
  static MemoryConfig nearest(const MemoryConfig& config) { return config.l1_kib > 0 ? own_cache(config) : config; }
  /// Half of the latency is spent on the way in, half on the way out, at least a cycle each.
  static Cycle request_latency(const MemoryConfig& config);
  static Cycle answer_latency(const MemoryConfig& config);

  ShapeCache(const MemoryConfig& config, std::vector<Client> clients, Channel<std::uint64_t>& to_memory,
             Channel<std::uint64_t>& from_memory);
  /// An L2 behind own caches. `others` ask it beside them.
  ShapeCache(const MemoryConfig& config, std::vector<OwnCache> clients, std::vector<Client> others,
             Channel<std::uint64_t>& to_memory, Channel<std::uint64_t>& from_memory);

  /// This cache asks an L2 where other caches ask the memory.
  void ask_a_cache() { asks_a_cache_ = true; }
  /// Holds part of these lines from the start.
  void warm(std::span<const std::uint64_t> lines, double part);
  std::vector<std::uint64_t> lines() const;
  /// The run is over: sends all lines that have been written and are still here to memory, in the order of their
  /// addresses.
  void drain(Cycle now);

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
    std::uint64_t line = 0;   // the line that an own cache asks for
    std::uint32_t lines = 1;  // lines in the answer
    std::uint32_t push = 0;   // 1 + a place in pushes_; 0: the answer is for the client alone
    std::uint32_t walk = 0;   // 1 + a strip that ends by its flag; 0: the length was named
  };
  /// An answer that leaves at `ready`. Among answers that leave at one time the one that was complete first goes first.
  struct Answer {
    Cycle ready = 0;
    std::uint64_t turn = 0;
    std::uint32_t client = 0, tag = 0;
    std::uint64_t line = 0;
    std::uint32_t lines = 1, push = 0;
    bool operator>(const Answer& o) const { return ready != o.ready ? ready > o.ready : turn > o.turn; }
  };

  /// A request to memory that leaves at `ready`.
  struct Outgoing {
    Cycle ready = 0;
    std::uint64_t turn = 0, line = 0;
    bool operator>(const Outgoing& o) const { return ready != o.ready ? ready > o.ready : turn > o.turn; }
  };
  /// A line of a request, of a pending one or (kWriter, kWholeWriter) of one that writes.
  struct LookUp {
    std::uint64_t line = 0;
    std::uint32_t request = 0;
  };
  struct Bank {
    std::uint64_t looked_up = 0;  // its ports are taken up to this line of time, of which a cycle has port_lines_
    Cycle busy_until = 0;         // the first cycle after the last in which a line was looked up
    std::uint32_t on_their_way = 0;
    std::deque<LookUp> waiting;  // the first has to be fetched, and cannot be yet
  };
  static constexpr std::uint32_t kWriter = ~0u, kWholeWriter = kWriter - 1;  // writes a part of a line, or all of it
  static constexpr std::uint32_t kNobody = kWriter - 2;                      // for a line behind the end of a strip

  /// The ways in which a line may stand.
  LineCache& ways_of(std::uint64_t line) { return ray_ways_ && line >= first_ray_line_ ? *ray_ways_ : cache_; }
  Bank& bank_of(std::uint64_t line) { return banks_.size() == 1 ? banks_[0] : banks_[line / parts_ % banks_.size()]; }
  void take(std::uint32_t client, const FetchRequest& request, Cycle now);
  void take_line(std::uint32_t client, std::uint64_t request, Cycle now);
  std::uint32_t begin(const Pending& pending);
  void answer(const Answer& answer, Cycle now);
  void write_through(const FetchRequest& request, Cycle now);
  bool writes_whole(const FetchRequest& request, std::uint64_t i) const;
  void write_back(const FetchRequest& request, Cycle now);
  void look_up(const LookUp& one, Cycle now);
  bool try_look_up(Bank& bank, const LookUp& one, Cycle now);
  void walk_on(std::uint32_t walk, Cycle now);
  Cycle looked_up(const LookUp& one, Bank& bank, Cycle now);
  bool read(Bank& bank, const LookUp& one, Cycle now);
  bool write(Bank& bank, const LookUp& one, Cycle now);
  bool can_fetch(const Bank& bank) const { return mshrs_ == 0 || bank.on_their_way < mshrs_; }
  void fill(std::uint64_t line, Cycle now);
  void insert(std::uint64_t line, Cycle now);
  void to_memory(Cycle leaves, std::uint64_t request);
  Cycle take_port(Bank& bank, Cycle now);
  void complete(std::uint32_t index);
  std::uint32_t begin_push(const FetchRequest& request);
  void push(std::uint32_t index, Cycle arrival);

  Cycle answer_latency_, memory_latency_;
  std::uint64_t line_bytes_, parts_;  // a line of the messages, and their number in one of the cache
  bool writes_back_;
  std::uint64_t mshrs_;         // registers of a bank for lines that it waits for; 0: no bound
  std::uint64_t answer_bytes_;  // a cycle; 0: no limit
  Cycle answers_free_ = 0;      // the wires of answers are taken up to this cycle
  LineCache cache_;
  std::optional<LineCache> ray_ways_;  // with `memory.l2_ray_ways`, for all but shapes
  std::uint64_t first_ray_line_;
  std::vector<Bank> banks_;
  std::vector<Client> clients_;
  std::vector<OwnCache> own_caches_;  // numbered before the clients
  bool asks_a_cache_ = false;         // is an own cache
  Channel<std::uint64_t>&to_memory_, &from_memory_;
  std::uint64_t port_lines_;  // a cycle
  bool in_order_;             // requests to memory leave in the order in which they are made
  std::priority_queue<Outgoing, std::vector<Outgoing>, std::greater<>> outgoing_;  // unless they are in order
  std::priority_queue<Answer, std::vector<Answer>, std::greater<>> answers_;
  std::uint64_t next_turn_ = 0;
  std::vector<Pending> pending_;
  std::vector<std::uint32_t> free_pending_;
  struct Push {
    PushedShapes shapes;
    std::uint64_t clients = 0;  // a bit each
  };
  std::vector<Push> pushes_;
  std::vector<std::uint32_t> free_pushes_;
  StripWalks walks_;
  MissingLines missing_;  // with pending requests
  Cycle next_ = 0;        // next(), at the end of the last run()
  Statistics statistics_;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/statistics/cache_counts.h"
#include "ringbus/cycle/memory/translator.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shapes/cache/cache_answers.h"
#include "ringbus/cycle/shapes/cache/cache_banks.h"
#include "ringbus/cycle/shapes/cache/cache_clients.h"
#include "ringbus/cycle/shapes/cache/memory_requests.h"
#include "ringbus/cycle/shapes/cache/missing_lines.h"
#include "ringbus/cycle/shapes/cache/pending_requests.h"
#include "ringbus/cycle/shapes/cache/tag_array.h"
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
/// A part may ask it to fetch lines ahead. These are looked up as others are, and nobody gets them. One for which its
/// bank has no miss register is dropped, and never makes others wait for a register.
///
/// With `memory.translation` a line that goes to the memory, or is asked for there, needs its page: this is looked up
/// in a TLB when the line would leave. Without it the line waits for a walker (Translator), which reads its entries
/// from the memory. Lines that have waited leave then, as many a cycle as the ports look up.
///
/// With `memory.l2_sector_bytes` "line" here means a sector (see fetched_bytes()), but for replacement.
class ShapeCache final : public Agent {
 public:
  using Client = CacheClient;
  using OwnCache = OwnCacheClient;
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
  ShapeCache(const ShapeCache&) = delete;  // its parts refer to its clients and counts
  ShapeCache& operator=(const ShapeCache&) = delete;

  /// This cache asks an L2 where other caches ask the memory.
  void ask_a_cache() { asks_a_cache_ = true; }
  /// Holds the last of these lines from the start, as many as it has room for, whose number between 0 and 1, which each
  /// line has, is in [from, to).
  void warm(std::span<const std::uint64_t> lines, double from, double to);
  std::vector<std::uint64_t> lines() const { return tags_.lines(); }
  std::vector<std::uint64_t> recent_lines() const { return tags_.recent(); }
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
  const AheadCounts& ahead() const { return ahead_; }

 private:
  // In the place of a request's number, for a line that nobody waits for.
  static constexpr std::uint32_t kWriter = ~0u, kWholeWriter = kWriter - 1;  // writes a part of a line, or all of it
  static constexpr std::uint32_t kNobody = kWriter - 2;  // for a line behind the end of a strip, or fetched ahead

  void take(std::uint32_t client, const FetchRequest& request, Cycle now);
  void take_line(std::uint32_t client, std::uint64_t request, Cycle now);
  void fetch_ahead(const FetchRequest& request, Cycle now);
  void take_write(const FetchRequest& request, Cycle now);
  void write_through(std::uint64_t line, bool whole, Cycle now);
  bool writes_whole(const FetchRequest& request, std::uint64_t i) const;
  void walk_on(std::uint32_t walk, Cycle now);
  void look_up(const LineLookUp& one, Cycle now);
  bool try_look_up(CacheBank& bank, const LineLookUp& one, Cycle now);
  bool read(CacheBank& bank, const LineLookUp& one, Cycle now);
  bool write(CacheBank& bank, const LineLookUp& one, Cycle now);
  void fill(std::uint64_t line, Cycle now);
  void insert(std::uint64_t line, Cycle now);
  void line_there(std::uint32_t index, std::uint64_t line, Cycle at);
  void ask_memory(Cycle leaves, std::uint64_t request);
  void read_entry(Cycle now);
  void take_entry(Cycle now);

  /// A request to the memory, and the time at which it would leave.
  struct Leaving {
    Cycle at = 0;
    std::uint64_t request = 0;
  };

  std::uint64_t line_bytes_;  // of a line of the messages
  bool writes_back_;
  bool asks_a_cache_ = false;         // is an own cache
  std::vector<OwnCache> own_caches_;  // numbered before the clients
  std::vector<Client> clients_;
  Channel<std::uint64_t>& from_memory_;
  CacheCounts statistics_;
  AheadCounts ahead_;
  TagArray tags_;
  CacheBanks banks_;
  PendingRequests pending_;
  MissingLines missing_;  // with pending requests
  MemoryRequests to_memory_;
  Translator<Leaving> pages_;
  std::uint64_t lines_per_cycle_;  // that its ports look up
  CacheAnswers answers_;
  Cycle next_ = 0;  // next(), at the end of the last run()
};

}  // namespace carousel::ringbus::cycle

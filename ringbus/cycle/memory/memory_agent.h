#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/config/fields/memory.h"
#include "core/statistics/memory_counts.h"
#include "ringbus/cycle/memory/touched_lines.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/results/dram_use.h"
#include "ringbus/results/memory_request.h"
#include "ringbus/time/agent.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// The memory behind the caches: a pipe, or DRAM with banks. It takes requests for lines in the order in which they
/// arrive (at one time: of the caches). It may go by a clock of its own, which its width and its answers then follow;
/// what it tells of itself is in cycles of the resources.
class MemoryAgent : public Agent {
 public:
  struct Client {
    Channel<std::uint64_t>* requests = nullptr;  ///< line numbers, with kWriteLine for a write
    Channel<std::uint64_t>* answers = nullptr;
  };
  static Cycle request_latency(const MemoryConfig& config) { return way_there(config.dram_latency_cycles); }
  static Cycle answer_latency(const MemoryConfig& config) { return way_back(config.dram_latency_cycles); }

  bool polled() const override { return false; }
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override { return ""; }

  /// Its cycles, and those of the resources. Before the start.
  void tell_time(const ClockRatio& from_core) { from_core_ = from_core; }
  /// From now on the bytes that it has moved are read over time, at most so often.
  void sample(std::size_t most) { samples_ = CounterSamples(most, 1); }
  virtual void close(Cycle end) = 0;
  const CounterSamples& samples() const { return samples_; }
  /// From now on requests are appended to the log.
  void log(MemoryLog* log) { log_ = log; }

  /// So far; the bytes are those that it has read.
  MemoryCounts counts() const {
    return {counts_.lines, counts_.lines * line_bytes_, counts_.lines_written, from_core_.to_core(moving())};
  }
  /// Reads so far of lines that had not been read before.
  std::uint64_t first_reads() const { return first_reads_; }
  std::uint64_t line_bytes() const { return line_bytes_; }  ///< of a line of its messages
  Cycle last_step() const { return from_core_.to_core(last_step_); }
  /// The time at which all that it has taken so far is done.
  Cycle idle_from() const { return from_core_.to_core(done_from()); }
  double peak_bytes_per_cycle() const { return width() * from_core_.network_per_core(); }
  /// Activations of rows so far; of a pipe none.
  virtual std::uint64_t activations() const { return 0; }
  /// The use of DRAM with banks up to `end`. Call it after close().
  virtual std::optional<DramUse> dram_use(Cycle end) const = 0;

 protected:
  MemoryAgent(const MemoryConfig& config, std::vector<Client> clients)
      : answer_latency_(answer_latency(config)), line_bytes_(fetched_bytes(config)), clients_(std::move(clients)) {}

  // By its own clock.
  virtual Cycle done_from() const = 0;
  /// Cycles that moving the lines took, the last one rounded up.
  virtual Cycle moving() const = 0;
  virtual double width() const = 0;

  /// Fills in the readings that are due before anything happens at `now`, each by `read(at, row)` with its time by the
  /// clock of the resources.
  template <class Read>
  void look_at(Cycle now, const Read& read) {
    const Cycle seen = from_core_.equal() ? now : from_core_.before(now);
    if (samples_.due(seen)) [[unlikely]]
      samples_.until(seen, read);
  }
  Cycle next_request() const {
    Cycle first = kNever;
    for (const Client& client : clients_) first = std::min(first, client.requests->next());
    return first;
  }
  /// Counts a request that has been taken. Returns whether it is a write.
  bool count(std::uint64_t request, Cycle now) {
    const bool write = (request & kWriteLine) != 0;
    ++(write ? counts_.lines_written : counts_.lines);
    if (!write) first_reads_ += touched_.insert(request);
    if (log_ != nullptr) [[unlikely]]
      log_->push_back({from_core_.to_core(now), (request & ~kWriteLine) * line_bytes_,
                       static_cast<std::uint32_t>(line_bytes_), write});
    return write;
  }

  ClockRatio from_core_;
  Cycle answer_latency_;
  std::uint64_t line_bytes_;
  std::vector<Client> clients_;
  MemoryCounts counts_;  // of lines only
  TouchedLines touched_;
  std::uint64_t first_reads_ = 0;
  Cycle next_ = 0;  // next(), at the end of the last run()
  Cycle last_step_ = 0;
  CounterSamples samples_;
  MemoryLog* log_ = nullptr;
};

/// The memory that the configuration names. `clock_mhz`: of its clock.
std::unique_ptr<MemoryAgent> make_memory(const MemoryConfig& config, std::int64_t clock_mhz,
                                         std::vector<MemoryAgent::Client> clients);

}  // namespace carousel::ringbus::cycle

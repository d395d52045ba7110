#pragma once

#include <vector>

#include "core/config/config.h"
#include "ringbus/cycle/time/agent.h"
#include "ringbus/cycle/time/channel.h"
#include "ringbus/results/counter_samples.h"

namespace carousel::ringbus::cycle {

/// The memory behind the caches: one channel that moves so many bytes a cycle, a fixed latency, no banks. Lines
/// are served in the order in which requests arrive (at one time: of the caches), one behind the other without a gap:
/// a wide channel moves several in a cycle, and a line may begin where another ends within one.
class Memory final : public Agent {
 public:
  struct Client {
    Channel<std::uint64_t>* requests = nullptr;  ///< line numbers, with kWriteLine for a write
    Channel<std::uint64_t>* answers = nullptr;
  };
  static Cycle request_latency(const MemoryConfig& config);
  static Cycle answer_latency(const MemoryConfig& config);

  Memory(const MemoryConfig& config, std::vector<Client> clients);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override { return ""; }

  /// From now on the bytes that it has moved are read over time, at most so often.
  void sample(std::size_t most) { samples_ = CounterSamples(most, 1); }
  void close(Cycle end);
  const CounterSamples& samples() const { return samples_; }

  std::uint64_t lines() const { return lines_; }  ///< read
  std::uint64_t lines_written() const { return lines_written_; }
  /// Cycles that moving the lines took, the last one rounded up.
  Cycle busy() const { return ceil_div(bytes(), width_); }

 private:
  std::uint64_t bytes() const { return (lines_ + lines_written_) * line_bytes_; }

  Cycle answer_latency_;
  std::uint64_t line_bytes_, width_;
  std::vector<Client> clients_;
  std::uint64_t moved_ = 0;  // the channel is taken up to this byte of time, of which a cycle has width_
  std::uint64_t lines_ = 0, lines_written_ = 0;
  Cycle next_ = 0;  // next(), at the end of the last run()
  CounterSamples samples_;
};

}  // namespace carousel::ringbus::cycle

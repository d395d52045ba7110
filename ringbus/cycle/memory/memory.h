#pragma once

#include <vector>

#include "ringbus/cycle/memory/memory_agent.h"

namespace carousel::ringbus::cycle {

/// A memory of one channel that moves so many bytes a cycle, with a fixed latency and no banks. Lines
/// are served in the order in which requests arrive, one behind the other without a gap:
/// a wide channel moves several in a cycle, and a line may begin where another ends within one.
class Memory final : public MemoryAgent {
 public:
  Memory(const MemoryConfig& config, std::vector<Client> clients);

  Cycle next() const override { return next_request(); }
  void run(Cycle end) override;
  void close(Cycle end) override;

  std::optional<DramUse> dram_use(Cycle) const override { return std::nullopt; }

 private:
  Cycle done_from() const override { return ceil_div(moved_, width_); }
  Cycle moving() const override { return ceil_div(bytes(), width_); }
  double width() const override { return static_cast<double>(width_); }
  std::uint64_t bytes() const { return (counts_.lines + counts_.lines_written) * line_bytes_; }

  std::uint64_t width_;
  std::uint64_t moved_ = 0;  // the channel is taken up to this byte of time, of which a cycle has width_
};

}  // namespace carousel::ringbus::cycle

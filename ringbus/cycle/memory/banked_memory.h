#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "ringbus/cycle/memory/dram/dram.h"
#include "ringbus/cycle/memory/memory_agent.h"

namespace carousel::ringbus::cycle {

/// DRAM with banks behind the caches (`memory.dram.preset`). A line is answered when its last byte is there.
class BankedMemory final : public MemoryAgent {
 public:
  /// `clock_mhz`: of its clock, beside which DRAM has its own.
  BankedMemory(const MemoryConfig& config, std::int64_t clock_mhz, std::vector<Client> clients);

  Cycle next() const override;
  void run(Cycle end) override;
  void close(Cycle end) override;

  std::uint64_t activations() const override { return dram_.activations(); }
  std::optional<DramUse> dram_use(Cycle end) const override {
    return dram_.use(dram_.of_engine(from_core_.to_network(end)));
  }

 private:
  Cycle done_from() const override { return last_step_ + 1; }  // from the last command on
  Cycle moving() const override { return dram_.busy(); }
  double width() const override { return dram_.peak_bytes_per_cycle(); }
  Cycle next_step() const;

  Dram dram_;
  std::uint64_t clients_of_line_;
};

}  // namespace carousel::ringbus::cycle

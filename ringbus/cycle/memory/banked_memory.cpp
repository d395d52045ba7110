#include "ringbus/cycle/memory/banked_memory.h"

#include <algorithm>

#include "ringbus/cycle/memory/memory.h"

namespace carousel::ringbus::cycle {

BankedMemory::BankedMemory(const MemoryConfig& config, std::int64_t clock_mhz, std::vector<Client> clients)
    : MemoryAgent(config, std::move(clients)), dram_(config.dram, clock_mhz), clients_of_line_(clients_.size()) {}

/// The engine's cycle in which DRAM does something next.
Cycle BankedMemory::next_step() const {
  const DramCycle next = dram_.next();
  return next == kDramNever ? kNever : dram_.engine_of(next);
}

Cycle BankedMemory::next() const {
  return std::min(next_request(), next_step());
}

void BankedMemory::run(Cycle end) {
  // A tag is a line and its client.
  const auto answer = [this](std::uint64_t tag, DramCycle done) {
    clients_[tag % clients_of_line_].answers->send(dram_.engine_end(done) + answer_latency_, tag / clients_of_line_);
  };
  for (next_ = next(); next_ < end; next_ = next()) {
    const Cycle now = last_step_ = next_;
    look_at(now, [this](Cycle, std::span<std::uint64_t> row) { row[0] = dram_.served_bytes(); });
    const DramCycle arrival = dram_.of_engine(now);
    for (std::size_t c = 0; c < clients_.size(); ++c) {
      while (clients_[c].requests->next() <= now) {
        const std::uint64_t request = clients_[c].requests->take(), line = request & ~kWriteLine;
        dram_.push(line * line_bytes_, line_bytes_, count(request, now), line * clients_of_line_ + c, arrival);
      }
    }
    dram_.run(dram_.of_engine(now + 1), answer);
  }
}

void BankedMemory::close(Cycle end) {
  dram_.close(dram_.of_engine(from_core_.to_network(end)));
  samples_.close(end, [this](Cycle, std::span<std::uint64_t> row) { row[0] = dram_.served_bytes(); });
}

std::unique_ptr<MemoryAgent> make_memory(const MemoryConfig& config, std::int64_t clock_mhz,
                                         std::vector<MemoryAgent::Client> clients) {
  if (config.dram.preset == DramConfig::Preset::kPipe) return std::make_unique<Memory>(config, std::move(clients));
  return std::make_unique<BankedMemory>(config, clock_mhz, std::move(clients));
}

}  // namespace carousel::ringbus::cycle

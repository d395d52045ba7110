#include "ringbus/cycle/memory/memory.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

Memory::Memory(const MemoryConfig& config, std::vector<Client> clients)
    : MemoryAgent(config, std::move(clients)), width_(static_cast<std::uint64_t>(config.dram_bytes_per_cycle)) {}

void Memory::run(Cycle end) {
  for (next_ = next(); next_ < end;) {
    const Cycle now = last_step_ = next_;
    next_ = kNever;
    look_at(now, [this](Cycle at, std::span<std::uint64_t> row) {
      // Lines that have been asked for are moved without a gap.
      const std::uint64_t by_now = from_core_.passed(at, width_);
      row[0] = bytes() - (moved_ > by_now ? moved_ - by_now : 0);
    });
    for (const Client& client : clients_) {
      while (client.requests->next() <= now) {
        moved_ = std::max(moved_, now * width_) + line_bytes_;
        const std::uint64_t line = client.requests->take();
        if (count(line, now)) [[unlikely]]
          continue;
        client.answers->send(ceil_div(moved_, width_) + answer_latency_, line);
      }
      next_ = std::min(next_, client.requests->next());
    }
  }
}

void Memory::close(Cycle end) {
  samples_.close(end, [this, end](Cycle at, std::span<std::uint64_t> row) {
    const std::uint64_t by_now = from_core_.passed(at, width_);
    row[0] = bytes() - (at < end && moved_ > by_now ? moved_ - by_now : 0);
  });
}

}  // namespace carousel::ringbus::cycle

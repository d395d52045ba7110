#include "ringbus/cycle/memory/memory.h"

#include <algorithm>

#include "ringbus/cycle/messages/memory_messages.h"

namespace carousel::ringbus::cycle {

Cycle Memory::request_latency(const MemoryConfig& config) {
  return way_there(config.dram_latency_cycles);
}

Cycle Memory::answer_latency(const MemoryConfig& config) {
  return way_back(config.dram_latency_cycles);
}

Memory::Memory(const MemoryConfig& config, std::vector<Client> clients)
    : answer_latency_(answer_latency(config)),
      line_bytes_(static_cast<std::uint64_t>(config.line_bytes)),
      width_(static_cast<std::uint64_t>(config.dram_bytes_per_cycle)),
      clients_(std::move(clients)) {}

Cycle Memory::next() const {
  Cycle first = kNever;
  for (const Client& client : clients_) first = std::min(first, client.requests->next());
  return first;
}

void Memory::run(Cycle end) {
  for (next_ = next(); next_ < end;) {
    const Cycle now = next_;
    next_ = kNever;
    if (samples_.due(now)) [[unlikely]]
      samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) {
        // Lines that have been asked for are moved without a gap.
        row[0] = bytes() - (moved_ > at * width_ ? moved_ - at * width_ : 0);
      });
    for (const Client& client : clients_) {
      while (client.requests->next() <= now) {
        moved_ = std::max(moved_, now * width_) + line_bytes_;
        const std::uint64_t line = client.requests->take();
        if ((line & kWriteLine) != 0) [[unlikely]] {
          ++lines_written_;
          continue;
        }
        ++lines_;
        client.answers->send(ceil_div(moved_, width_) + answer_latency_, line);
      }
      next_ = std::min(next_, client.requests->next());
    }
  }
}

void Memory::close(Cycle end) {
  samples_.close(end, [this, end](Cycle at, std::span<std::uint64_t> row) {
    row[0] = bytes() - (at < end && moved_ > at * width_ ? moved_ - at * width_ : 0);
  });
}

}  // namespace carousel::ringbus::cycle

#pragma once

#include "ringbus/cycle/memory/shape_cache.h"
#include "ringbus/cycle/memory/shape_memory.h"
#include "ringbus/cycle/messages/side_ports.h"

namespace carousel::ringbus::cycle {

/// A resource's end of the wires to its cache.
class ShapePort {
 public:
  /// Keeps the ports' channels.
  ShapePort(const MemoryConfig& config, const SidePorts& ports)
      : requests_(*ports.fetch),
        answers_(*ports.fetched),
        latency_(ShapeCache::request_latency(config)),
        line_bytes_(static_cast<std::uint64_t>(config.line_bytes)) {}

  /// Asks for the lines of `span`; `tag` comes back when all are there. Requests are made in order of time.
  void request(const ShapeSpan& span, std::uint32_t tag, Cycle now) {
    const std::uint64_t first = span.address / line_bytes_, last = (span.address + span.bytes - 1) / line_bytes_;
    requests_.send(now + latency_, {first, static_cast<std::uint32_t>(last - first + 1), tag});
  }
  /// The time at which the next answer comes.
  Cycle next() const { return answers_.next(); }
  std::uint32_t take() { return answers_.take().tag; }

 private:
  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  Cycle latency_;
  std::uint64_t line_bytes_;
};

}  // namespace carousel::ringbus::cycle

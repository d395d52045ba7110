#pragma once

#include "ringbus/cycle/memory/shape_cache.h"
#include "ringbus/cycle/memory/shape_memory.h"
#include "ringbus/cycle/messages/side_ports.h"

namespace carousel::ringbus::cycle {

/// Set in the tag of a read of spilled collection entries; the others are of shapes.
inline constexpr std::uint32_t kSpillTag = std::uint32_t{1} << 31;

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
  void request(const ShapeSpan& span, std::uint32_t tag, Cycle now) { send(span, tag, false, now); }
  /// Writes the lines of `span`.
  void write(const ShapeSpan& span, Cycle now) { send(span, 0, true, now); }
  /// The time at which the next answer comes.
  Cycle next() const { return answers_.next(); }
  std::uint32_t take() { return answers_.take().tag; }

 private:
  void send(const ShapeSpan& span, std::uint32_t tag, bool writes, Cycle now) {
    const std::uint64_t first = span.address / line_bytes_, last = (span.address + span.bytes - 1) / line_bytes_;
    requests_.send(now + latency_, {first, static_cast<std::uint32_t>(last - first + 1), tag, writes});
  }

  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  Cycle latency_;
  std::uint64_t line_bytes_;
};

}  // namespace carousel::ringbus::cycle

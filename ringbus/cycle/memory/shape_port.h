#pragma once

#include "ringbus/cycle/memory/shape_buffer.h"
#include "ringbus/cycle/memory/shape_cache.h"
#include "ringbus/cycle/messages/side_ports.h"

namespace carousel::ringbus::cycle {

/// A resource's access to shape data: the strips it has at hand, and its cache for the others.
class ShapePort {
 public:
  /// Keeps the ports' channels.
  ShapePort(const MemoryConfig& config, const SidePorts& ports)
      : buffer_(config),
        requests_(*ports.fetch),
        answers_(*ports.fetched),
        latency_(ShapeCache::request_latency(config)),
        line_bytes_(static_cast<std::uint64_t>(config.line_bytes)) {}

  bool has(const ShapeSpan& strip) { return buffer_.has(strip); }
  void keep(const ShapeSpan& strip) { buffer_.keep(strip); }
  /// Asks for the lines of `strip`; `tag` comes back when all are there.
  void request(const ShapeSpan& strip, std::uint32_t tag, Cycle now) {
    const std::uint64_t first = strip.address / line_bytes_, last = (strip.address + strip.bytes - 1) / line_bytes_;
    requests_.send(now + latency_, {first, static_cast<std::uint32_t>(last - first + 1), tag});
  }
  /// The time at which the next answer comes.
  Cycle next() const { return answers_.next(); }
  std::uint32_t take() { return answers_.take().tag; }

 private:
  ShapeBuffer buffer_;
  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  Cycle latency_;
  std::uint64_t line_bytes_;
};

}  // namespace carousel::ringbus::cycle

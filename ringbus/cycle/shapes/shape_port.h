#pragma once

#include <cstdint>
#include <vector>

#include "core/numeric/divisor.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::ringbus::cycle {

/// Set in the tag of a read of spilled collection entries; the others are of shapes.
inline constexpr std::uint32_t kSpillTag = std::uint32_t{1} << 31;

/// A resource's end of the wires to its cache.
class ShapePort {
 public:
  /// Keeps the ports' channels.
  ShapePort(const MemoryConfig& config, const LinkConfig& link, const SidePorts& ports)
      : requests_(*ports.fetch),
        answers_(*ports.fetched),
        wire_(link, ShapeCache::request_latency(ShapeCache::nearest(config))),
        line_bytes_(fetched_bytes(config)) {
    for (Channel<ShapeHint>* hint : ports.hints)
      hints_.push_back({hint, SideWire(link, ShapeCache::request_latency(config))});
  }

  /// Asks for the lines of `span`; `tag` comes back when all are there. Requests are made in order of time.
  /// The clients in `others` get the bytes too.
  void request(const ShapeSpan& span, std::uint32_t tag, Cycle now, std::uint64_t others = 0) {
    FetchRequest message = lines_of(span);
    message.tag = tag;
    message.ends_by_flag = span.most > 0;
    if (others != 0) [[unlikely]] {
      message.others = others;
      message.wanted = span.bytes;
      message.skipped = static_cast<std::uint32_t>(line_bytes_.remainder(span.address));
    }
    requests_.send(wire_.send(message.bytes(), now), message);
    lines_ += message.lines;
    if ((tag & kSpillTag) == 0)
      for (HintPort& hint : hints_) hint.send({message.first_line}, now);
  }
  /// Writes `span`, likewise in order of time.
  void write(const ShapeSpan& span, Cycle now) {
    FetchRequest message = lines_of(span);
    message.written = span.bytes;
    message.skipped = static_cast<std::uint32_t>(line_bytes_.remainder(span.address));
    requests_.send(wire_.send(message.bytes(), now), message);
  }
  /// The time at which the next answer comes.
  Cycle next() const { return answers_.next(); }
  std::uint32_t take() { return answers_.take().tag; }
  std::uint64_t lines() const { return lines_; }  ///< asked for

 private:
  /// The near end of a wire to a part that hears of requests for shapes.
  struct HintPort {
    Channel<ShapeHint>* to;
    SideWire wire;
    void send(const ShapeHint& hint, Cycle now) { to->send(wire.send(hint.bytes(), now), hint); }
  };

  FetchRequest lines_of(const ShapeSpan& span) const {
    const std::uint64_t first = line_bytes_.quotient(span.address),
                        last = line_bytes_.quotient(span.address + span.bytes - 1);
    return {first, static_cast<std::uint32_t>(last - first + 1)};
  }

  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  SideWire wire_;
  Divisor line_bytes_;
  std::uint64_t lines_ = 0;
  std::vector<HintPort> hints_;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "ringbus/cycle/rings/ring_end.h"
#include "ringbus/cycle/traffic/traffic_agent.h"
#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_sink.h"
#include "ringbus/cycle/traffic/traffic_source.h"
#include "ringbus/time/fifo.h"

namespace carousel::ringbus::cycle {

/// What stands at a stop of a ring: a source and a sink, or nothing at a router. The queues of the source have no
/// bound; answers go before packets of its own. A packet to its own stop passes inside, without the ring. What is
/// created and delivered goes by the clock of the resources, all else by that of the network.
class RingStation final : public RingEnd {
 public:
  /// The parts of workload.traffic that it follows.
  struct Settings {
    TrafficNodeSettings node;
    std::uint32_t reply_bytes = 0;
    Cycle serve_cycles = 0;
  };

  /// Keeps references to shape and places, the stops of all resources. `packets`: how many it takes from the source.
  RingStation(std::uint32_t place, const RingShape& shape, const std::vector<std::uint32_t>& places,
              const Settings& settings, std::optional<TrafficSource> source, std::uint64_t packets,
              TrafficWindow window);

  Cycle due() const override { return std::min(own_ready(), answers_.empty() ? kNever : answers_.front().ready); }
  RingPacket take(Cycle now) override;
  void arrive(const RingPacket& packet, Cycle tail) override;

  const TrafficSink& sink() const { return sink_; }
  TrafficOffered offered() const { return offered_; }

 private:
  Cycle own_ready() const { return own_ ? own_->ready : kNever; }
  void create();
  void offer(Cycle created, std::uint32_t to);
  std::uint32_t flit_hops(std::uint32_t to, std::uint32_t direction, std::uint32_t bytes) const;

  std::uint32_t place_;
  const RingShape& shape_;
  const std::vector<std::uint32_t>& places_;
  Settings settings_;
  std::optional<TrafficSource> source_;
  std::uint64_t left_;             // packets of the source after the one that waits
  std::optional<RingPacket> own_;  // of the source, the next one
  Fifo<RingPacket> answers_;
  Cycle window_begin_;
  TrafficSink sink_;
  TrafficOffered offered_;
};

}  // namespace carousel::ringbus::cycle

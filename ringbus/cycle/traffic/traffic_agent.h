#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_sink.h"
#include "ringbus/cycle/traffic/traffic_token.h"
#include "ringbus/time/agent.h"

namespace carousel::ringbus::cycle {

/// The packets that a source has created within the window.
struct TrafficOffered {
  std::uint64_t packets = 0;
  std::uint64_t routers = 0;  ///< that these have to visit, first and last included
  std::uint64_t travel = 0;   ///< cycles that these would be on their way if each were alone
};

/// A node of a network without rays, with a sink.
class TrafficAgent : public Agent {
 public:
  using In = InPortOf<TrafficToken>;
  using Out = OutPortOf<TrafficToken>;

  TrafficAgent(const TrafficNodeSettings& settings, TrafficWindow window)
      : window_(window),
        marks_{settings.clock.to_network(window.begin), settings.clock.to_network(window.end)},
        sink_(settings, window) {}

  const TrafficSink& sink() const { return sink_; }
  virtual TrafficOffered offered() const = 0;
  /// What the link of a port has moved.
  struct Moved {
    std::uint64_t packets = 0;
    Cycle busy = 0, stalled = 0;
  };
  virtual Moved moved(std::size_t port) const = 0;
  /// Cycles of the window in which the link of `port` moved a flit, once the run is over.
  virtual Cycle busy_in_window(std::size_t port) const = 0;

 protected:
  /// The ends of the window by the clock of the network.
  Cycle mark(std::size_t i) const { return marks_[i]; }

  TrafficWindow window_;
  std::array<Cycle, 2> marks_;
  TrafficSink sink_;
};

}  // namespace carousel::ringbus::cycle

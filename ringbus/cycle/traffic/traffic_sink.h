#pragma once

#include <algorithm>
#include <cstdint>

#include "core/numeric/latency_histogram.h"
#include "ringbus/cycle/traffic/traffic_plan.h"
#include "ringbus/cycle/traffic/traffic_settings.h"
#include "ringbus/cycle/traffic/traffic_token.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The sink of a node. One flit a cycle gets out to it, by the clock of the network, and it counts the packets that it
/// is given, by the clock of the resources.
class TrafficSink {
 public:
  TrafficSink(const TrafficNodeSettings& settings, TrafficWindow window)
      : clock_(settings.clock), eject_cycles_(settings.eject_cycles), flits_(settings.flits), window_(window) {}

  /// Tells whether it takes a packet whose last flit comes at `tail`.
  bool open(Cycle tail) const { return free_ <= tail; }
  /// The first tail for which it is open.
  Cycle opens() const { return free_; }
  /// Takes a packet; only when open.
  void deliver(const TrafficToken& token, Cycle tail) {
    free_ = tail + flits_;
    count(token, clock_.leave(tail) + eject_cycles_);
  }
  /// Counts a packet that is delivered at `at`.
  void count(const TrafficToken& token, Cycle at) {
    last_ = std::max(last_, at);
    ++delivered_;
    if (at >= window_.begin && at < window_.end) {
      ++accepted_;
      accepted_hops_ += token.hops;
    }
    if (token.created >= window_.begin) latency_.add(at - token.created);
  }

  const LatencyHistogram& latency() const { return latency_; }  ///< latency of measured packets delivered here
  std::uint64_t delivered() const { return delivered_; }
  std::uint64_t accepted() const { return accepted_; }            ///< delivered within the window
  std::uint64_t accepted_hops() const { return accepted_hops_; }  ///< links that these crossed
  Cycle last() const { return last_; }                            ///< when something was last delivered

 private:
  ClockRatio clock_;
  Cycle eject_cycles_;
  std::uint16_t flits_;
  TrafficWindow window_;
  Cycle free_ = 0;  // for the next packet's tail
  LatencyHistogram latency_;
  std::uint64_t delivered_ = 0, accepted_ = 0, accepted_hops_ = 0;
  Cycle last_ = 0;
};

}  // namespace carousel::ringbus::cycle

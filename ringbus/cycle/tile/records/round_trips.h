#pragma once

#include <cstdint>
#include <vector>

#include "core/numeric/latency_histogram.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Measures how long each packet of a resource was under way, and, counted apart from that, the packet-cycles of all.
/// By Little's law (J. D. C. Little, Operations Research 9 (1961)) the two must agree.
class RoundTrips {
 public:
  /// Measures packets `first` to `first + packets - 1`.
  RoundTrips(std::uint32_t first, std::size_t packets) : first_(first), left_at_(packets) {}

  void inject(std::uint32_t packet, Cycle now) {
    left_at_[packet - first_] = now;
    count(now);
    ++out_;
  }
  void return_home(std::uint32_t packet, Cycle now) {
    latency_.add(now - left_at_[packet - first_]);
    count(now);
    --out_;
  }

  /// A packet has not come back, and will not be waited for.
  void forget(Cycle now) {
    count(now);
    --out_;
  }

  const LatencyHistogram& latency() const { return latency_; }
  Cycle packet_cycles() const { return packet_cycles_; }
  /// Up to `at`, which is not before the last event.
  Cycle packet_cycles(Cycle at) const { return packet_cycles_ + out_ * (at - since_); }

 private:
  void count(Cycle now) {
    packet_cycles_ += out_ * (now - since_);
    since_ = now;
  }

  std::uint32_t first_;
  std::vector<Cycle> left_at_;
  LatencyHistogram latency_;
  std::uint64_t out_ = 0;
  Cycle since_ = 0, packet_cycles_ = 0;
};

}  // namespace carousel::ringbus::cycle

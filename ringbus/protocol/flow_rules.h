#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/config/fields/topology.h"

namespace carousel::ringbus {

/// The rules of `topology.flow` for one port: when a packet of the resource's own may enter the network, and when
/// packets may come in (docs/how-it-works/design.md, Deadlock and the end). Holds no state; ports, queues and clocks
/// belong to the engines.
class FlowRules {
 public:
  /// `direct`: packets are sent straight to their next stop, or all nodes have room for all packets, so no ring of full
  /// queues can close and no rule is needed.
  FlowRules(Flow flow, bool direct) : flow_(flow), direct_(direct) {}

  /// Free places that the next queue must have when a packet is injected into it. The bubble rule leaves one for
  /// packets that are already on the ring.
  std::uint32_t places_to_inject() const { return bubble() ? 2 : 1; }
  bool bubble() const { return flow_ == Flow::kBubble && !direct_; }
  /// Without flow control injection goes before passing packets, so that a network which can stop does so soon.
  bool injects_first() const { return flow_ == Flow::kNone; }
  /// With credits, a source of packets that go only part of the way round waits for acknowledgements of deliveries.
  bool counts_deliveries() const { return flow_ == Flow::kCredits && !direct_; }

  /// Decides whether a packet may join the egress queue of its port: there is a place, and the bubble rule, if it
  /// applies, is kept. `free_places()` counts those of the next queue.
  template <class FreePlaces>
  bool may_inject(bool has_place, const FreePlaces& free_places) const {
    return has_place && (!bubble() || free_places() >= places_to_inject());
  }
  /// Packets that may stand in an egress queue when another one is injected behind them. On a ring packets on their way
  /// go first; sent directly, all packets there are have room; without flow control it is up to `batch`.
  std::size_t egress_limit(std::size_t batch) const {
    if (flow_ == Flow::kNone) return batch;
    return direct_ ? std::numeric_limits<std::size_t>::max() : 1;
  }

  /// Packets that may be received at once, at most `most`, by a port whose egress queue has no bound of its own.
  /// `waiting` stand in the egress queue that they would join.
  template <class FreePlaces>
  std::size_t receivable(std::size_t most, std::size_t waiting, const FreePlaces& free_places) const {
    if (direct_) return most;
    // On a ring a packet that cannot leave must not come in, or the egress queue would grow without a bound.
    if (waiting > 0) return 0;
    // A packet left in the egress queue takes a place that the bubble is counted on for. Three such packets can fill
    // the ring in spite of the bubble (tests/models/flow.pml, -DGREEDY_HAND). So only as many come in as can go on at
    // once, or a single one.
    if (bubble()) return std::min<std::size_t>(most, std::max<std::size_t>(1, free_places()));
    return most;
  }

 private:
  Flow flow_;
  bool direct_;
};

}  // namespace carousel::ringbus

#pragma once

#include "ringbus/cycle/rings/ring_shape.h"

namespace carousel::ringbus::cycle {

/// What stands at a stop of a ring: packets that wait to get on, and a receiver of those that get off, whom nothing
/// keeps from taking them. All times are by the clock of the ring.
class RingEnd {
 public:
  virtual ~RingEnd() = default;

  /// When the first packet is ready; kNever without one.
  virtual Cycle due() const = 0;
  /// Takes a packet that is ready `now`; only when due.
  virtual RingPacket take(Cycle now) = 0;
  /// A packet has come to this stop, whose last flit is here at `tail`. Tails do not decrease.
  virtual void arrive(const RingPacket& packet, Cycle tail) = 0;
};

}  // namespace carousel::ringbus::cycle

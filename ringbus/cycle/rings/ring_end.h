#pragma once

#include "ringbus/cycle/rings/ring_shape.h"

namespace carousel::ringbus::cycle {

/// What stands at a stop of a ring: packets that wait to get on, and a receiver of those that get off. Nothing keeps it
/// from taking them, unless it is a queue that has few places (`rule: slots` alone asks). All times are by the clock of
/// the ring.
class RingEnd {
 public:
  virtual ~RingEnd() = default;

  /// When the first packet is ready; kNever without one.
  virtual Cycle due() const = 0;
  /// Takes a packet that is ready `now`; only when due.
  virtual RingPacket take(Cycle now) = 0;
  /// Has a place for a packet that begins to get off.
  virtual bool has_place() const { return true; }
  /// Keeps a place for it until it arrives; only when there is one.
  virtual void keep_place() {}
  /// A packet has come to this stop, whose last flit is here at `tail`. Tails do not decrease.
  virtual void arrive(const RingPacket& packet, Cycle tail) = 0;
};

}  // namespace carousel::ringbus::cycle

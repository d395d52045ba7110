#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "ringbus/cycle/rings/ring_fabric.h"

namespace carousel::ringbus::cycle {

/// `stops.rule: slots`: slots of a flit go round, one for each cycle of a ring's length, and nothing holds them up.
/// - What is on the ring goes first: a stop puts a flit into a slot that passes it only if the slot is empty, or has
/// just
///   been emptied there.
/// - A flit gets off at its stop if the port is free. Of several that come at once the one that got on first does; the
///   others go round once more. For the oldest of those that were passed over the port is kept free when it comes round
///   again. So the oldest gets off in its second round at the latest, then the next one, and none goes round for ever.
/// - The flits of a packet get on one by one, by any ring of its direction, and the receiver puts them together.
/// - After `fair_after_cycles` a stop marks the first slot that passes without a mark of another stop. No other stop
///   fills it, so that it comes back empty once what is in it has got off. Without this a stop behind others that keep
///   the slots full may wait for as long as they do.
///
/// A packet of F flits over h links takes, with nobody in its way and a port of p cycles a flit,
///     F p - 1 + h latency_cycles + p - 1.
class SlotRing final : public RingFabric {
 public:
  SlotRing(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links);

  /// Also kNever if flits are under way of which none gets off any more, which would be a fault of this class.
  Cycle next() const override;
  void step(Cycle now) override;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  struct Slot {
    std::uint32_t packet = kNone;  // of the flit in it
    std::uint32_t to = 0;          // the stop of the flit
    std::uint32_t marked = kNone;  // the stop that alone may fill it
    Cycle entered = 0;
    bool first = false;  // the flit is the first of its packet
  };
  /// A packet of which flits are on the ring or still to get on.
  struct Flying {
    RingPacket packet;
    std::uint32_t left = 0;  // flits that have not got off
  };
  /// From the ring into the stop.
  struct Port {
    Cycle free = 0;
    Cycle claimed_at = kNever;  // when the oldest flit that was passed over comes round again
    Cycle claimant = 0;         // when that flit got on

    void claim(Cycle at, Cycle entered) {
      if (claimed_at != kNever && claimant <= entered) return;
      claimed_at = at;
      claimant = entered;
    }
    /// A flit would still be in the port when an older one comes round again.
    bool is_kept(Cycle now, Cycle cycles, Cycle entered) const {
      return claimed_at != kNever && now + cycles > claimed_at && entered >= claimant;
    }
  };
  struct Stop {
    std::uint32_t packet = kNone;  // that gets on
    std::uint32_t left = 0;        // flits of it that have not got on
    bool first = false;            // the next one is the first
    Cycle ready = 0;               // when the next one is through the port
    Port port;
    Slot* marked = nullptr;
  };

  Slot& slot(std::uint32_t lane, std::uint32_t stop, Cycle now);
  void get_off(std::uint32_t stop, Cycle now);
  void get_on(std::uint32_t stop, Cycle now);
  void begin_packet(std::uint32_t stop, Cycle now);
  Slot* free_slot(std::uint32_t stop, Cycle now);
  void mark_slot(std::uint32_t stop, Cycle now);

  Cycle length_, port_cycles_, fair_after_;
  std::vector<Slot> slots_;  // by lane and number
  std::vector<Stop> stops_;
  std::vector<Flying> flying_;
  std::vector<std::uint32_t> unused_;  // places of flying_
  Cycle now_ = 0, moved_ = 0;          // something was done last
};

}  // namespace carousel::ringbus::cycle

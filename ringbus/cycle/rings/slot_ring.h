#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "ringbus/cycle/rings/ring_fabric.h"

namespace carousel::ringbus::cycle {

/// `stops.rule: slots`: slots of a flit go round, one for each cycle of a ring's length, and nothing holds them up.
/// - What is on the ring goes first: a stop puts a flit into a slot that passes it only if the slot is empty, or has
///   just been emptied there.
/// - A flit gets off at its stop if the port is free. Of several that come at once the one that got on first does; the
///   others go round once more. For the oldest of those that were passed over the port is kept free when it comes round
///   again. So the oldest gets off in its second round at the latest, then the next one, and none goes round for ever.
/// - Where a stop has few places, a packet keeps one from its first flit on. A flit of a packet that finds none goes
///   round once more, as from ring to ring in R. Ausavarungnirun et al., Design and Evaluation of Hierarchical Rings
///   with Deflection Routing, SBAC-PAD 2014. Of such packets the one that got on first gets the next place: while it is
///   known, no later one takes any.
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

  /// Nothing but packets that come to stops while flits are under way of which none finds a place.
  Cycle next() const override;
  /// Does also the steps before it in which flits went round alone.
  void step(Cycle now) override;
  bool rides() const override { return flying_.size() > unused_.size(); }
  void look_again(Cycle now) override { moved_ = now; }

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
    Cycle began = 0;         // to get on
    bool has_place = false;  // at the stop where it gets off
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
    std::uint32_t first_in_line = kNone;  // the oldest packet that has found no place here
    Slot* marked = nullptr;
  };

  void turn(Cycle now);
  Slot& slot(std::uint32_t lane, std::uint32_t stop, Cycle now);
  bool finds_place(std::uint32_t stop, std::uint32_t packet);
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

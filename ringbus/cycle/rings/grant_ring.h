#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/rings/ring_fabric.h"

namespace carousel::ringbus::cycle {

/// `stops.rule: grants`: an arbiter knows all rings, and grants a packet its whole way: the port of its stop, a ring of
/// its direction with all segments of the way, each for as long as the packet passes, and the port of its destination.
/// What is under way is never held up, and stops hold nothing. A segment goes to packets in the order of their grants.
/// - Stops have their turns (round robin); each has one request, for the first packet that waits there.
/// - `transfers`: packets that stops may be putting onto one ring at a time; `start_cycles` between two on one ring.
/// - `command_cycles` between any two grants: a command bus on which each transfer is announced to all stops.
/// - After `fair_after_cycles` the request that has waited longest is granted before any other. Without this a stop
///   with a long way may wait for as long as others use parts of it.
///
/// A packet of B beats over h links takes, with nobody in its way, grant_cycles + h latency_cycles + B - 1.
class GrantRing final : public RingFabric {
 public:
  GrantRing(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links);

  Cycle next() const override;
  void step(Cycle now) override;

 private:
  struct Stop {
    RingPacket packet;        // of the request
    bool asks = false;        // there is a request
    Cycle granted_after = 0;  // the request has reached the arbiter
    Cycle out_free = 0, in_free = 0;
  };
  struct Lane {
    std::vector<Cycle> free;  // by segment: when the next packet may be granted it
    std::vector<Cycle> ends;  // of packets that stops are putting onto the ring
    Cycle next_start = 0;
  };

  /// When a request could have been granted if only its own port were in the way.
  static Cycle wanted(const Stop& stop) { return std::max(stop.granted_after, stop.out_free); }
  void ask(Cycle now);
  /// The stop that has waited too long, the longest of several; as many as there are stops if none has.
  std::uint32_t overdue(Cycle now) const;
  bool grant(std::uint32_t stop, Cycle now);
  bool is_free(const Lane& lane, const RingPacket& packet, std::uint32_t hops, Cycle now) const;

  RingStops rules_;
  std::vector<Stop> stops_;
  std::vector<Lane> lanes_;
  std::uint32_t turn_ = 0;
  Cycle next_command_ = 0, now_ = 0;
};

}  // namespace carousel::ringbus::cycle

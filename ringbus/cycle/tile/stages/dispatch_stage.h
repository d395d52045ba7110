#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "ringbus/cycle/tile/records/tile_recorder.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The time of a resource's dispatch stage, which looks through the IDs of one packet after another,
/// `packets.ids_per_cycle` a cycle.
class DispatchStage {
 public:
  /// Keeps a reference.
  DispatchStage(std::int64_t ids_per_cycle, TileRecorder& recorder)
      : ids_per_cycle_(static_cast<Cycle>(ids_per_cycle)), recorder_(recorder) {}

  /// How long it reads `ids` IDs; a packet without any takes a cycle as well.
  Cycle cycles(std::size_t ids) const { return std::max<Cycle>(1, ceil_div(ids, ids_per_cycle_)); }
  /// It reads a packet's IDs from `now` on, or when it is free. `has_trip`: the packet is on its way from and to its
  /// owner, and not one of new rays or one whose owner does not wait for it.
  void occupy(Cycle now, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip = true) {
    hold(now, cycles(ids), ids, kind, packet, has_trip);
  }
  /// The same for a number of cycles.
  void hold(Cycle now, Cycle cycles, std::size_t ids, SliceKind kind, PacketId packet, bool has_trip = true) {
    const Cycle start = std::max(free_at_, now);
    if (start != ends_) since_ = start;
    ends_ = free_at_ = start + cycles;
    busy_ += cycles;
    recorder_.dispatched(start, free_at_, ids, kind, packet, has_trip);
  }
  /// It takes nothing up for a while (`faults.resource: {kind: pause}`), and is not busy meanwhile.
  void pause(Cycle now, Cycle cycles) { free_at_ = std::max(free_at_, now) + cycles; }

  /// The first cycle in which it can take something up.
  Cycle free_at() const { return free_at_; }

  /// A packet without rays of this resource has passed, with `rays` rays of others.
  void count_idle_visit(std::size_t rays) {
    ++idle_visits_;
    idle_visit_rays_ += rays;
  }
  std::uint64_t idle_visits() const { return idle_visits_; }
  std::uint64_t idle_visit_rays() const { return idle_visit_rays_; }

  /// Busy cycles, those of the packet that it reads included up to its end.
  Cycle busy() const { return busy_; }
  Cycle busy_before(Cycle at) const { return busy_ - (ends_ > at ? ends_ - std::max(at, since_) : 0); }
  /// The run is over: it may still look through the IDs of the last packet.
  void close(Cycle end) { busy_ = busy_before(end); }

 private:
  Cycle ids_per_cycle_;
  TileRecorder& recorder_;
  Cycle free_at_ = 0;                      // later than ends_ when it pauses
  Cycle since_ = 0, ends_ = 0, busy_ = 0;  // from the first to the last cycle of its work without a break
  std::uint64_t idle_visits_ = 0, idle_visit_rays_ = 0;
};

}  // namespace carousel::ringbus::cycle

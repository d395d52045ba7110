#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "ringbus/cycle/messages/control_messages.h"
#include "ringbus/protocol/admission.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/protocol/ray_rounds.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// New rays that go round the ring in packets and take slots where there are any (`rays.placement: first_taker`), or
/// at their address (`addressed`), seen from one resource: the groups that wait here for a packet, the slots of this
/// resource, and the IDs that come back. Does nothing with other placements.
///
/// A resource gives out its slots itself, so that parts on different threads need not agree on who asked first. A slot
/// is free again in the cycle in which its ray is handed over.
class TravellingRays {
 public:
  /// Keeps a reference to the machine. `times`: the ledger of all rays' time; may be null.
  TravellingRays(Machine& machine, ResourceId here, const LinkConfig& link, RayTimes* times);

  bool on() const { return on_; }
  /// Ray control has sent a group, which waits for a packet.
  void arrive(NewRays&& rays);
  bool waiting() const { return !waiting_.empty(); }
  /// Rays of the group that goes next.
  std::size_t next_rays() const { return waiting_.front().rays.size(); }
  /// Puts that group into a packet, for a round of all resources.
  void load(Packet& packet);
  /// Gives rays of a packet slots of this resource. Returns the cycle in which the last record has been loaded; `now`
  /// if there is none.
  Cycle take_slots(Packet& packet, Cycle now);
  /// The packet is back, or need not go out: the last slots, then the IDs are kept until the records are there. Rays
  /// without a slot wait again. The packet is empty afterwards.
  void retire_at_owner(Packet& packet, Cycle now);
  /// Moves IDs whose records have been loaded to `admission`. Returns whether there were any.
  bool admit(Cycle now, Admission& admission);
  /// The time at which the next IDs can be admitted.
  Cycle next() const { return due_.empty() ? kNever : due_.front().at; }
  /// Gives back slots of rays that are handed over. Returns the times at which they were given out, one a slot.
  std::vector<Cycle> free(std::span<const std::uint32_t> slots, Cycle now);

  bool at_rest() const { return waiting_.empty() && due_.empty(); }
  std::size_t taken() const { return taken_; }                 ///< slots by the last take_slots()
  std::uint64_t held(Cycle at) const { return held_.at(at); }  ///< slots in use, times cycles

 private:
  struct Due {
    Cycle at = 0;
    std::vector<RayId> ids;
  };
  void note_taken(RayId id, Cycle now);

  Machine& machine_;
  ResourceId here_;
  bool on_;
  ResourceTimes* times_;
  RayRounds rounds_;
  Cycle record_cycles_, load_free_ = 0;
  std::deque<RayGroup> waiting_;
  std::deque<Due> due_;           // in order of time
  std::vector<Cycle> placed_at_;  // by slot
  std::size_t taken_ = 0;
  Level held_;
};

}  // namespace carousel::ringbus::cycle

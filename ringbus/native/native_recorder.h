#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/config/config.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/rank_share.h"
#include "ringbus/results/recording.h"
#include "ringbus/topology/topology.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// The logs of a native run, one a resource and one a router, which write also for the links that leave them.
class NativeRecorder {
 public:
  using Clock = std::chrono::steady_clock;

  /// Each resource gets an equal part of the slices, as none knows of the others', and so do messages.
  NativeRecorder(const Config& config, const RankShare& share, std::size_t packets, const TimelineOptions& timeline,
                 FollowedRay* ray);

  /// Track `track` is the resource's, the one after the number of resources is that of link 0, and after the links come
  /// two for each rank: of messages to it and from it.
  Recording of_resource(ResourceId id);
  /// A router has no track; it notes the links that leave it.
  Recording of_router(ResourceId node) { return {&slices_[node.value], &trips_, 0, nullptr}; }
  std::uint32_t link_track(std::uint32_t wire) const { return static_cast<std::uint32_t>(facts_.size()) + wire; }
  /// Nanoseconds since the start.
  // The start may lie ahead by as much as this rank's clock is not known.
  std::uint64_t now() const {
    const Clock::duration since = Clock::now() - start_;
    return since.count() > 0 ? static_cast<std::uint64_t>(since.count()) : 0;
  }
  /// The run begins now: for `ranks` at the same moment at each, whose clocks are compared. Null if there is one.
  void start(Transport* ranks);

  // With ranks.

  std::uint64_t trip(PacketId packet) const { return trips_.of(packet.value); }
  /// A packet has come from another rank.
  void bring(PacketId packet, std::uint64_t trip) { trips_.bring(packet.value, trip); }
  struct Ends {
    std::uint32_t from = 0, to = 0;  ///< ranks, of which one is this
  };
  /// One thread at a time. `number`: of the message among those between its ends; it ends now.
  void note_message(Ends ends, SliceKind kind, std::uint64_t number, std::size_t packets, std::uint64_t begin);

  /// Call it when the threads have been joined. With `ranks` the first rank gets the slices of all; every rank calls,
  /// when no message is under way.
  Timeline timeline(Transport* ranks) const;
  std::vector<RayFact> facts() const;

 private:
  Timeline own_timeline() const;

  Topology topology_;
  RankShare share_;
  FollowedRay* ray_;
  Clock::time_point start_{};
  TripTable trips_;
  std::deque<SliceLog> slices_;  // by node
  std::deque<RayLog> facts_;     // by resource
  SliceLog messages_;
  std::vector<RankClock> clocks_;  // at the start, by rank
};

}  // namespace carousel::ringbus

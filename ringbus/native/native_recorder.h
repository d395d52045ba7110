#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/config/config.h"
#include "ringbus/results/recording.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus {

/// The logs of a native run, one a resource, which writes also for the links that leave it.
class NativeRecorder {
 public:
  using Clock = std::chrono::steady_clock;

  /// Each resource gets an equal part of the slices, as none knows of the others'.
  NativeRecorder(const Config& config, std::size_t packets, const TimelineOptions& timeline, FollowedRay* ray);

  /// Track `track` is the resource's, and the one after the number of resources is that of link 0.
  Recording of_resource(ResourceId id);
  std::uint32_t link_track(std::uint32_t wire) const { return static_cast<std::uint32_t>(slices_.size()) + wire; }
  /// Nanoseconds since the start.
  std::uint64_t now() const { return static_cast<std::uint64_t>((Clock::now() - start_).count()); }
  void start(Clock::time_point at) { start_ = at; }

  /// When the threads have been joined.
  Timeline timeline() const;
  std::vector<RayFact> facts() const;

 private:
  Topology topology_;
  FollowedRay* ray_;
  Clock::time_point start_{};
  TripTable trips_;
  std::deque<SliceLog> slices_;  // by resource
  std::deque<RayLog> facts_;     // likewise
};

}  // namespace carousel::ringbus

#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "core/config/fields/testers.h"
#include "ringbus/cycle/fabric/link_recorder.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/observation.h"
#include "ringbus/results/recording.h"

namespace carousel::ringbus::cycle {

/// The logs of a whole machine: one a node of the network, which its links share, and one of shading.
class Recorder {
 public:
  /// Keeps a reference to the topology. `most_contexts`: the most that a resource has. `has_distributor`: the machine's
  /// testers stand behind one.
  Recorder(const TestersConfig& testers, std::int64_t most_contexts, bool has_distributor, const Machine& machine,
           const Observation& observed);

  Recording of_resource(ResourceId id);
  /// The recording of ray control and shading.
  Recording of_shading();
  LinkRecorder of_link(ResourceId from, std::uint32_t wire);

  /// Ends the recording of slices if there are as many as are wanted, or thins them. While no agent runs.
  void limit();
  /// When the run is over.
  Timeline timeline(Cycle end) const;
  std::vector<RayFact> facts() const;

 private:
  bool records_slices() const { return options_.most > 0 || ray_ != nullptr; }

  const Topology& topology_;
  TimelineOptions options_;
  FollowedRay* ray_;
  std::uint32_t contexts_, testers_, per_resource_;
  bool has_distributor_;
  TripTable trips_;
  std::deque<SliceLog> slices_;  // by node
  std::deque<RayLog> facts_;     // by node, and of shading
  bool cut_ = false;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "ringbus/cycle/rays/travelling_rays.h"
#include "ringbus/cycle/tile/records/tile_recorder.h"
#include "ringbus/cycle/tile/stages/completed_port.h"
#include "ringbus/cycle/tile/stages/rays_in_test.h"
#include "ringbus/packets/statistics_sink.h"

namespace carousel::ringbus::cycle {

/// The completed rays of a resource on their way to shading: gathered during a step, and sent at its end.
class Completions {
 public:
  /// Keeps references. `follows_tests`: a ray can be in several tests at once (RaysInTest).
  Completions(ResourceId id, RayStore& store, bool follows_tests, const LinkConfig& link, const SidePorts& ports,
              TravellingRays& travelling, StatisticsSink& sink, TileRecorder& recorder)
      : id_(id),
        store_(store),
        in_test_(store.slots(), follows_tests),
        port_(link, ports),
        travelling_(travelling),
        sink_(sink),
        recorder_(recorder) {}

  RaysInTest& in_test() { return in_test_; }
  CompletedPort& port() { return port_; }

  /// Takes rays, and slots that are free with them; both are empty afterwards.
  void take(HitBatch& rays, std::vector<std::uint32_t>& slots) { in_test_.hand_over(rays, slots, done_, slots_); }
  /// Sends all that have been taken.
  void hand_over(Cycle now) {
    if (done_.empty()) return;
    recorder_.completed(done_, slots_, now);
    sink_.record({.kind = EventKind::kComplete, .resource = id_, .rays = static_cast<std::uint32_t>(done_.size())});
    recorder_.step(now, StepKind::kComplete, 0, done_.size());
    std::vector<Cycle> placed;
    if (travelling_.on()) placed = travelling_.free(slots_, now);
    port_.send(done_, slots_, std::move(placed), now, sent_hits(store_));
  }
  /// Forgets what is left of a machine that begins anew: slots of bundles, which wait for a ray to go with (ray control
  /// has all slots back then), and rays in test.
  void discard() {
    slots_.clear();
    in_test_.clear();
  }

 private:
  ResourceId id_;
  RayStore& store_;
  RaysInTest in_test_;
  CompletedPort port_;
  TravellingRays& travelling_;
  StatisticsSink& sink_;
  TileRecorder& recorder_;
  HitBatch done_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus::cycle {

/// Bytes of hits that the rays of a store have found and that go with the next completed rays.
inline std::uint64_t sent_hits(RayStore& store) {
  return store.nearest() == nullptr ? 0 : store.nearest()->take_sent_bytes();
}

/// Sends a resource's completed rays to shading, record after record, a link's width a cycle, and behind them the hits
/// that rays have found besides their closest. A note takes a cycle.
class CompletedPort {
 public:
  CompletedPort(const LinkConfig& link, const SidePorts& ports)
      : completed_(*ports.completed),
        width_(static_cast<std::uint64_t>(link.bytes_per_cycle)),
        record_cycles_(ceil_div(sizeof(RayRecord), width_)),
        latency_(control_latency(link)) {}

  /// Takes the rays, the slots they leave and CompletedRays::placed; all are empty afterwards.
  void send(HitBatch& done, std::vector<std::uint32_t>& slots, std::vector<Cycle>&& placed, Cycle now,
            std::uint64_t hit_bytes = 0) {
    free_at_ = std::max(free_at_, now) + done.size() * record_cycles_ + ceil_div(hit_bytes, width_);
    completed_.send(free_at_ + latency_, {std::move(done), std::move(slots), {}, std::move(placed), hit_bytes});
    done.clear();
    slots.clear();
  }

  /// Sends a note behind the rays that have been sent.
  void notify(CompletedRays::Note note, Cycle now) {
    free_at_ = std::max(free_at_, now) + 1;
    completed_.send(free_at_ - 1 + latency_, {{}, {}, note});
  }

 private:
  Channel<CompletedRays>& completed_;
  std::uint64_t width_;
  Cycle record_cycles_, latency_;
  Cycle free_at_ = 0;
};

}  // namespace carousel::ringbus::cycle

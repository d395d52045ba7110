#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "ringbus/cycle/tile/stages/completed_port.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus::cycle {

/// The rays of a resource that have ended, on their way to shading, and what all its rays have on their stacks.
class EndedRays {
 public:
  EndedRays(const LinkConfig& link, const SidePorts& ports) : port_(link, ports) {}

  /// A walk's stack had `before` bytes and has now those that it says.
  void stacked(std::uint64_t before, const RayWalk& walk) {
    const std::uint64_t held = walk.stack_bytes().held;
    held_ = held_ - before + held;
    stack_.peak_bytes = std::max(stack_.peak_bytes, held_);
    stack_.ray_peak_bytes = std::max(stack_.ray_peak_bytes, held);
  }
  /// The ray in `slot` leaves it.
  void add(std::uint32_t slot, const RayWalk& walk, RayStore& store) {
    stack_.pushed_bytes += walk.stack_bytes().pushed;
    stack_.popped_bytes += walk.stack_bytes().popped;
    store.finish(slot, done_);
    store_ = &store;
    store.retire(slot);
    slots_.push_back(slot);
  }
  const HitBatch& rays() const { return done_; }
  void send(Cycle now) { port_.send(done_, slots_, {}, now, store_ == nullptr ? 0 : sent_hits(*store_)); }
  const StackTraffic& stack() const { return stack_; }

 private:
  CompletedPort port_;
  RayStore* store_ = nullptr;  ///< of the rays; null before the first
  HitBatch done_;
  std::vector<std::uint32_t> slots_;
  StackTraffic stack_;
  std::uint64_t held_ = 0;
};

}  // namespace carousel::ringbus::cycle

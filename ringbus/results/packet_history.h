#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/statistics/ray_stage_counts.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus {

/// The stages of a packet since it was issued, one behind the other without a gap. Whoever holds the packet writes.
class PacketHistory {
 public:
  /// The packet is issued.
  void begin(Cycle now) {
    spans_.clear();
    begun_ = now;
    waits_ = RayStage::kIssue;
    hops_ = 0;
    open_ = true;
  }
  /// It has retired: nothing is noted until it is issued again.
  void close() { open_ = false; }

  /// It has been in `stage` since what was noted last. `resource`: where it is tested, or waits for its shapes.
  void until(Cycle end, RayStage stage, std::uint32_t resource = kNowhere) {
    if (!open_ || end <= last()) return;
    if (!spans_.empty() && spans_.back().stage == stage && spans_.back().resource == resource)
      spans_.back().end = end;
    else
      spans_.push_back({end, resource, stage});
  }
  /// Dispatch reads it; before that it waited for that.
  void dispatched(Cycle begin, Cycle end) {
    until(begin, waits_);
    until(end, RayStage::kDispatch);
    waits_ = RayStage::kEgress;
  }
  /// It is sent; before that it waited for that.
  void sent(Cycle at, Cycle arrival) {
    until(at, waits_);
    until(arrival, RayStage::kLink);
    waits_ = RayStage::kInput;
    hops_ += open_;
  }
  /// Its rays of `resource` have been tested; before that they waited for their shapes.
  void tested(std::uint32_t resource, Cycle begin, Cycle end) {
    until(begin, RayStage::kShapes, resource);
    until(end, RayStage::kTest, resource);
    waits_ = RayStage::kEgress;
  }

  Cycle begun() const { return begun_; }
  Cycle last() const { return spans_.empty() ? begun_ : spans_.back().end; }
  std::uint32_t hops() const { return hops_; }

  /// Calls `take(stage, cycles)` for the spans from `from` on, which is not before begun(), as a ray of `resource` sees
  /// them: tests elsewhere are those of others.
  template <class Take>
  void since(Cycle from, std::uint32_t resource, const Take& take) const {
    Cycle begin = begun_;
    for (const Span& span : spans_) {
      const bool elsewhere = span.resource != kNowhere && span.resource != resource;
      if (span.end > from) take(elsewhere ? RayStage::kOthers : span.stage, span.end - std::max(begin, from));
      begin = span.end;
    }
  }

 private:
  static constexpr std::uint32_t kNowhere = ~0u;
  struct Span {
    Cycle end = 0;
    std::uint32_t resource = kNowhere;
    RayStage stage = RayStage::kIssue;
  };
  std::vector<Span> spans_;
  Cycle begun_ = 0;
  std::uint32_t hops_ = 0;
  RayStage waits_ = RayStage::kIssue;  // what it is in from last() until something else begins
  bool open_ = false;
};

}  // namespace carousel::ringbus

#pragma once

#include <cstdint>
#include <vector>

#include "core/statistics/warp_counts.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// What is counted of a resource's warps.
class WarpLog {
 public:
  explicit WarpLog(std::int64_t lanes) : lanes_(static_cast<std::uint64_t>(lanes)) {}

  void formed(std::size_t rays) {
    ++counts_.warps;
    counts_.rays += rays;
  }
  /// Lanes have asked together: so many for nodes and for leaves, `helped` of them for rays of others.
  void step(std::uint64_t nodes, std::uint64_t leaves, std::uint64_t helped) {
    ++counts_.steps;
    counts_.tested += nodes + leaves;
    counts_.box_steps += nodes > 0;
    counts_.box_tested += nodes;
    counts_.leaf_steps += leaves > 0;
    counts_.leaf_tested += leaves;
    counts_.helped += helped;
  }
  /// A warp ends that was under way for `held` cycles. add() tells it of each ray, in the order of its lanes.
  class Ended {
   public:
    Ended(WarpLog& log, std::uint64_t held, std::size_t rays) : log_(log), held_(held), empty_(log.lanes_ - rays) {}
    /// The ray had not ended for `in_test` of these cycles.
    void add(std::uint32_t bounce, std::uint64_t in_test) {
      if (log_.bounces_.size() <= bounce) log_.bounces_.resize(bounce + 1);
      const std::uint64_t lanes = 1 + empty_;
      empty_ = 0;
      log_.bounces_[bounce] += LaneUse{lanes * held_, in_test};
      log_.counts_.lane_cycles += lanes * held_;
      log_.counts_.ray_cycles += in_test;
    }

   private:
    WarpLog& log_;
    std::uint64_t held_, empty_;
  };
  Ended end(std::uint64_t held, std::size_t rays) { return {*this, held, rays}; }
  void packed(std::uint64_t bytes) { counts_.packed_bytes += bytes; }

  const WarpCounts& counts() const { return counts_; }
  const std::vector<LaneUse>& bounces() const { return bounces_; }

 private:
  std::uint64_t lanes_;
  WarpCounts counts_;
  std::vector<LaneUse> bounces_;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Warps of rays (`testers.simt`), and the lanes of which they made no use.
struct WarpCounts {
  std::uint64_t warps = 0, rays = 0, steps = 0, tested = 0, box_steps = 0, box_tested = 0, leaf_steps = 0,
                leaf_tested = 0, helped = 0, lane_cycles = 0, ray_cycles = 0, lines_wanted = 0, lines_read = 0,
                packing = 0, packed_bytes = 0, spilled_bytes = 0, refilled_bytes = 0, votes = 0, prefetches = 0,
                lines_prefetched = 0, lines_prefetched_used = 0;

  static constexpr auto counters() {
    using C = WarpCounts;
    return std::array{
        Counter{"warps", &C::warps, "warps", "warps that were formed"},
        Counter{"rays", &C::rays, "rays", "rays in warps when they were formed"},
        Counter{"steps", &C::steps, "steps", "steps of warps: lanes that asked for their next nodes together"},
        Counter{"tested", &C::tested, "lanes", "lanes that tested a node or a leaf in these steps"},
        Counter{"box_steps", &C::box_steps, "steps", "steps in which a lane tested a node"},
        Counter{"box_tested", &C::box_tested, "lanes", "lanes that tested a node"},
        Counter{"leaf_steps", &C::leaf_steps, "steps", "steps in which a lane tested a leaf"},
        Counter{"leaf_tested", &C::leaf_tested, "lanes", "lanes that tested a leaf"},
        Counter{"helped", &C::helped, "lanes", "those that tested it for a ray of another lane, with idle_lanes: help"},
        Counter{"lane_cycles", &C::lane_cycles, "lane-cycles", "lanes of warps that were under way, with a ray or not"},
        Counter{"ray_cycles", &C::ray_cycles, "lane-cycles", "those whose ray had not ended"},
        Counter{"lines_wanted", &C::lines_wanted, "lines", "lines that the lanes of a step asked for, each for itself"},
        Counter{"lines_read", &C::lines_read, "lines", "lines that were read for them, each once for all lanes"},
        Counter{"packing", &C::packing, "cycles", "rays were packed into warps, with compaction: repack"},
        Counter{"packed_bytes", &C::packed_bytes, "bytes",
                "entries in the registers of stacks that were moved from lane to lane"},
        Counter{"spilled_bytes", &C::spilled_bytes, "bytes", "entries of stacks that were written to memory"},
        Counter{"refilled_bytes", &C::refilled_bytes, "bytes", "entries of stacks that were read back"},
        Counter{"votes", &C::votes, "rays", "rays whose next node was in another treelet, with prefetch: treelet"},
        Counter{"prefetches", &C::prefetches, "treelets", "treelets that were chosen, likewise"},
        Counter{"lines_prefetched", &C::lines_prefetched, "lines", "lines of these that were not there and were read"},
        Counter{"lines_prefetched_used", &C::lines_prefetched_used, "lines", "those of them that lanes then asked for"},
    };
  }
  friend bool operator==(const WarpCounts&, const WarpCounts&) = default;
};

/// The lanes of warps, a row for each bounce of their rays. Lanes without a ray count for the bounce of the warp's
/// first ray, so that the rows add up to WarpCounts.
struct LaneUse {
  std::uint64_t lane_cycles = 0, ray_cycles = 0;

  static constexpr auto counters() {
    using C = LaneUse;
    return std::array{
        Counter{"lane_cycles", &C::lane_cycles, "lane-cycles", "lanes that rays of this bounce held or left empty"},
        Counter{"ray_cycles", &C::ray_cycles, "lane-cycles", "those whose ray had not ended"},
    };
  }
  friend bool operator==(const LaneUse&, const LaneUse&) = default;
};

}  // namespace carousel

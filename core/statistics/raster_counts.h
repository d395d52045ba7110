#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The work of the raster pass that finds the first hits of camera rays.
struct RasterCounts {
  std::uint64_t triangles = 0, binned = 0, tested = 0, any_hit_calls = 0, hits = 0, misses = 0, left_to_rays = 0;

  static constexpr auto counters() {
    using C = RasterCounts;
    return std::array{
        Counter{"triangles", &C::triangles, "triangles", "triangles of all instances"},
        Counter{"binned", &C::binned, "triangles", "triangles sorted into tiles, once for each tile"},
        Counter{"tested", &C::tested, "tests", "tests of the edge functions of a triangle at a sample"},
        Counter{"asked", &C::any_hit_calls, "samples", "any-hit calls: samples at which a primitive is not opaque"},
        Counter{"hits", &C::hits, "samples", "samples that meet a triangle"},
        Counter{"misses", &C::misses, "samples", "samples that meet nothing"},
        Counter{"left_to_rays", &C::left_to_rays, "samples",
                "samples near procedural primitives, for which camera rays were sent"},
    };
  }
  friend bool operator==(const RasterCounts&, const RasterCounts&) = default;
};

}  // namespace carousel

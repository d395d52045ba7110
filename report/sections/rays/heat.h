#pragma once

#include <vector>

#include "report/sections/visitor.h"

namespace carousel::report {

/// What the rays of one pixel took, those of all its samples and bounces together.
struct PixelHeat {
  std::uint64_t x = 0, y = 0, rays = 0, cycles = 0, tests = 0, hops = 0, waiting = 0;
};

template <class V>
void describe(V& v, const PixelHeat& r) {
  v.field("x", r.x, "pixels", "column, from the left");
  v.field("y", r.y, "pixels", "row, from the top");
  v.field("rays", r.rays, "rays", "rays of its paths");
  v.field("cycles", r.cycles, "cycles", "cycles of these rays from their making until they had been shaded");
  v.field("tests", r.tests, "tests", "nodes and leaves that they were tested against");
  v.field("hops", r.hops, "links", "links that their packets crossed from their issue until the rays were tested");
  v.field("waiting", r.waiting, "cycles", "those of their cycles in which they were not in test");
}

/// The cost of the picture's pixels.
struct Heat {
  double cycles_mean = 0;
  std::vector<PixelHeat> slowest;
};

template <class V>
void describe(V& v, const Heat& r) {
  v.field("cycles_mean", r.cycles_mean, "cycles", "mean of all pixels whose paths were traced");
  v.section("slowest", r.slowest,
            "pixels whose rays took most cycles, most first; carousel follow --pixel tells the life of each ray");
}

}  // namespace carousel::report

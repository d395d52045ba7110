#pragma once

#include <algorithm>
#include <cstdint>

#include "core/config/fields/testers.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// The rays that some tests are of.
struct TestedRays {
  std::uint64_t rays = 0;
  std::uint64_t in_cell = 0;  ///< at most so many of them belong to one lane; 0: a ray may take any lane
};

/// The lanes of test units that start a vector of tests at a time (US 9633468, SIMD forms of a tester). Either each
/// lane holds a ray, and the shapes of the strip stream past; or each lane holds a shape, and the rays stream past.
/// Lanes without a ray, or without a shape, stay empty. The results of a packet are then brought into its order.
class Lanes {
 public:
  explicit Lanes(const TestersConfig::Simd& config)
      : lanes_(static_cast<std::uint64_t>(config.lanes)),
        reformat_(config.lanes > 1 ? static_cast<Cycle>(config.reformat_cycles) : 0),
        rays_in_lanes_(config.map == TestersConfig::Simd::Map::kRays) {}

  /// The vectors that `tests` of some rays take, which are tested against equally many shapes each, the last against
  /// fewer. With one lane these are the tests.
  std::uint64_t starts(std::uint64_t tests, const TestedRays& of) const {
    if (lanes_ == 1 || tests == 0) return tests;
    const std::uint64_t rays = std::clamp<std::uint64_t>(of.rays, 1, tests), shapes = ceil_div(tests, rays);
    if (!rays_in_lanes_) return rays * ceil_div(shapes, lanes_);
    return std::max(ceil_div(rays, lanes_), std::min(of.in_cell, rays)) * shapes;
  }
  std::uint64_t count() const { return lanes_; }
  /// The time to reformat the results of a packet.
  Cycle reformatting() const { return reformat_; }

 private:
  std::uint64_t lanes_;
  Cycle reformat_;
  bool rays_in_lanes_;
};

}  // namespace carousel::ringbus::cycle

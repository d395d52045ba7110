#pragma once

#include <algorithm>
#include <cstdint>

#include "core/config/fields/testers.h"
#include "ringbus/cycle/time/clock.h"

namespace carousel::ringbus::cycle {

/// The lanes of test units that start a vector of tests at a time (US 9633468, SIMD forms of a tester). Either each
/// lane holds a ray, and the shapes of the strip stream past; or each lane holds a shape, and the rays stream past.
/// Lanes without a ray, or without a shape, stay empty. The results of a packet are then brought into its order.
class Lanes {
 public:
  explicit Lanes(const TestersConfig::Simd& config)
      : lanes_(static_cast<std::uint64_t>(config.lanes)),
        reformat_(config.lanes > 1 ? static_cast<Cycle>(config.reformat_cycles) : 0),
        rays_in_lanes_(config.map == TestersConfig::Simd::Map::kRays) {}

  /// The vectors that `tests` of `rays` rays take, which are tested against equally many shapes each, the last against
  /// fewer. With one lane these are the tests.
  std::uint64_t starts(std::uint64_t tests, std::uint64_t rays) const {
    if (lanes_ == 1 || tests == 0) return tests;
    rays = std::clamp<std::uint64_t>(rays, 1, tests);
    const std::uint64_t shapes = ceil_div(tests, rays);
    return rays_in_lanes_ ? ceil_div(rays, lanes_) * shapes : rays * ceil_div(shapes, lanes_);
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

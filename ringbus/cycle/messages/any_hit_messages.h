#pragma once

#include <cstdint>
#include <vector>

namespace carousel::ringbus::cycle {

/// From a resource to shading, with `testers.any_hit: shader`: whether primitives that these rays meet let them
/// through.
struct AnyHitQuestion {
  std::vector<std::uint32_t> slots;  ///< of the rays, which are held until the answer
  std::uint64_t times = 0;           ///< primitives, all rays together
};

/// The answer, for the same rays. What it says has long been known to the resource: only the time is simulated.
struct AnyHitAnswer {
  std::vector<std::uint32_t> slots;
};

}  // namespace carousel::ringbus::cycle

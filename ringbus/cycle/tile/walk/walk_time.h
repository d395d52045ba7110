#pragma once

#include <cstdint>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// What a ray did in a visit in which it went its own way: its strips, its cycles in test, and the cycle of its end.
struct WalkTime {
  std::uint32_t strips = 0;
  Cycle in_test = 0, end = 0;
};

}  // namespace carousel::ringbus::cycle

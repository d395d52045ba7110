#pragma once

#include <cstdint>
#include <limits>

namespace carousel::ringbus::cycle {

/// A point of virtual time, or a length of it, in clock cycles.
using Cycle = std::uint64_t;
inline constexpr Cycle kNever = std::numeric_limits<Cycle>::max();

constexpr std::uint64_t ceil_div(std::uint64_t n, std::uint64_t by) { return (n + by - 1) / by; }

}  // namespace carousel::ringbus::cycle

#pragma once

#include <cstdint>
#include <limits>

namespace carousel::ringbus {

/// A point of virtual time, or a length of it, in clock cycles.
using Cycle = std::uint64_t;
inline constexpr Cycle kNever = std::numeric_limits<Cycle>::max();

constexpr std::uint64_t ceil_div(std::uint64_t n, std::uint64_t by) {
  return (n + by - 1) / by;
}

/// A latency that is spent half on the way there and half on the way back, at least a cycle each.
constexpr Cycle way_there(std::int64_t whole) {
  return whole < 2 ? 1 : static_cast<Cycle>(whole / 2);
}
constexpr Cycle way_back(std::int64_t whole) {
  return whole < 2 ? 1 : static_cast<Cycle>(whole) - way_there(whole);
}

}  // namespace carousel::ringbus

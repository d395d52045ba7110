#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ringbus/resource/visit/test_outcome.h"

namespace carousel::ringbus {

// The baseline instruction set has no population count, and a call for eight bits is dear.
inline constexpr std::array<std::int8_t, 256> kBitCount = [] {
  std::array<std::int8_t, 256> counts{};
  for (std::size_t i = 1; i < counts.size(); ++i) counts[i] = static_cast<std::int8_t>(counts[i / 2] + (i & 1));
  return counts;
}();

/// Adds the answer of a node's children to an outcome: one mask of children a ray.
inline void count_children(std::span<const std::uint8_t> masks, TestOutcome& outcome) {
  for (const std::uint8_t mask : masks) {
    outcome.children += static_cast<std::uint32_t>(kBitCount[mask]);
    outcome.misses += mask == 0;
  }
}

}  // namespace carousel::ringbus

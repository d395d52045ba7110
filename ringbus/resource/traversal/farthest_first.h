#pragma once

#include <bit>
#include <cstdint>

namespace carousel::ringbus {

/// Calls `visit(lane)` for each lane of `mask`, by falling entry, so that of what is pushed onto a stack the nearest
/// ends on top. Lanes break ties, the least one last, to keep the order a function of the ray.
template <class Visit>
void farthest_first(std::uint32_t mask, const float* entry, const Visit& visit) {
  while (mask != 0) {
    int farthest = std::countr_zero(mask);
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      if (entry[lane] >= entry[farthest]) farthest = lane;
    }
    mask &= ~(1u << farthest);
    visit(farthest);
  }
}

}  // namespace carousel::ringbus

#pragma once

#include <bit>
#include <cstdint>

#include "core/config/fields/collections.h"

namespace carousel::ringbus {

/// Calls `visit(lane)` for each lane of `mask`, the one that comes first last, so that it ends on top of a stack: the
/// nearest entry, where the least lane wins a tie, to keep the order a function of the ray; or the least lane.
template <class Visit>
void last_first(ChildOrder order, std::uint32_t mask, const float* entry, const Visit& visit) {
  const bool by_entry = order == ChildOrder::kNearest;
  while (mask != 0) {
    int last = std::bit_width(mask) - 1;
    if (by_entry)
      for (std::uint32_t rest = mask; rest != 0;) {
        const int lane = std::bit_width(rest) - 1;
        if (entry[lane] > entry[last]) last = lane;
        rest &= ~(1u << lane);
      }
    mask &= ~(1u << last);
    visit(last);
  }
}

}  // namespace carousel::ringbus

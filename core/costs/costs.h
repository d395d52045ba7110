#pragma once

#include <array>

#include "core/costs/cost_table.h"
#include "core/numeric/exponential.h"

namespace carousel {

/// The numbers of the table of costs as one machine has them: its configuration's own, or its profile's. Without a
/// profile all are zero.
struct Costs {
  std::array<double, kCostTable.size()> values{};

  /// In the unit of the cost's row.
  constexpr double of(Cost cost) const { return values[cost_index(cost)]; }
  /// Picojoules of an access of 64 bits to a store of `kib`: interpolated between the sizes of the table, with the
  /// logarithms of size and energy, and continued beyond them.
  double sram_access_pj(double kib) const {
    const double e8 = of(Cost::kSram8), e32 = of(Cost::kSram32), e1024 = of(Cost::kSram1024);
    const auto between = [&](double low_kib, double low, double high_kib, double high) {
      if (low <= 0 || high <= 0) return low;
      return low * pow_precise(high / low, log_precise(kib / low_kib) / log_precise(high_kib / low_kib));
    };
    return kib < 32 ? between(8, e8, 32, e32) : between(32, e32, 1024, e1024);
  }
};

}  // namespace carousel

#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The vectors in which shader workers of several lanes shaded completed rays.
struct ShadeVectorCounts {
  std::uint64_t vectors = 0, rays = 0;
  std::uint64_t runs = 0;  ///< runs of a shader for its rays of a vector

  static constexpr auto counters() {
    using C = ShadeVectorCounts;
    return std::array{
        Counter{"vectors", &C::vectors, "vectors", "vectors of completed rays that the workers shaded"},
        Counter{"rays", &C::rays, "rays", "rays of these"},
        Counter{"runs", &C::runs, "passes", "passes of a shader for its rays of a vector", Shown::kNever},
    };
  }
  friend bool operator==(const ShadeVectorCounts&, const ShadeVectorCounts&) = default;
};

/// The work of shader workers.
struct ShadingCounts {
  std::uint64_t busy = 0;      ///< worker-cycles, without resources that help
  std::uint64_t products = 0;  ///< counts of ShadeWork, as `lookups`
  std::uint64_t lookups = 0;
  ShadeVectorCounts vectors;
  friend bool operator==(const ShadingCounts&, const ShadingCounts&) = default;
};

}  // namespace carousel

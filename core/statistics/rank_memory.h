#pragma once

#include <array>
#include <cstdint>

#include "core/statistics/counters.h"

namespace carousel {

/// The memory of a rank.
struct RankMemory {
  std::uint64_t scene_bytes = 0, structure_bytes = 0, guest_bytes = 0, peak_memory_bytes = 0;

  static constexpr auto counters() {
    using C = RankMemory;
    return std::array{
        Counter{"scene_bytes", &C::scene_bytes, "bytes", "meshes and images that it has for shading"},
        Counter{"structure_bytes", &C::structure_bytes, "bytes", "acceleration structure that it has"},
        Counter{"guest_bytes", &C::guest_bytes, "bytes", "room for the shapes that packets bring from other ranks"},
        Counter{"peak_memory_bytes", &C::peak_memory_bytes, "bytes", "most memory that it has had"},
    };
  }
  friend bool operator==(const RankMemory&, const RankMemory&) = default;
};

}  // namespace carousel

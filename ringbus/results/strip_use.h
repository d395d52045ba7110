#pragma once

#include <cstdint>

namespace carousel::ringbus::cycle {

/// The leaves of a structure as strips of triangles (`bvh.leaves: strips`).
struct StripUse {
  std::uint64_t triangles = 0, strips = 0, vertices = 0;
  std::uint64_t bytes = 0;           ///< bytes of the leaves
  std::uint64_t separate_bytes = 0;  ///< that they would have with three vertices a triangle
  friend bool operator==(const StripUse&, const StripUse&) = default;
};

}  // namespace carousel::ringbus::cycle

#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace carousel::ringbus::cycle {

/// The vertices of a triangle: the bits of x, y and z of each.
using Corner = std::array<std::uint32_t, 3>;
using StripTriangle = std::array<Corner, 3>;

struct StripCounts {
  std::uint32_t strips = 0, vertices = 0;
  friend bool operator==(const StripCounts&, const StripCounts&) = default;
};

/// The strips in which a leaf holds its triangles (`bvh.leaves: strips`): each triangle of a strip but the first has
/// the last two vertices of the one before it and one of its own, so n triangles have n + 2 vertices. Vertices are the
/// same if they are so to the bit. The longest strip is taken out again and again (at one length the first that is
/// found), which is not always the least number of strips.
StripCounts triangle_strips(std::span<const StripTriangle> triangles);

}  // namespace carousel::ringbus::cycle

#include "ringbus/cycle/shapes/triangle_strips.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace carousel::ringbus::cycle {

namespace {

/// The vertex of a triangle that is neither `a` nor `b`, both of which it must have; null if it has not.
const Corner* third(const StripTriangle& triangle, const Corner& a, const Corner& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &one = triangle[(i + 1) % 3], &other = triangle[(i + 2) % 3];
    if ((one == a && other == b) || (one == b && other == a)) return &triangle[i];
  }
  return nullptr;
}

/// The strip that begins with `first`, whose vertices come in one of six orders.
std::vector<std::size_t> strip_from(std::span<const StripTriangle> triangles, const std::vector<bool>& used,
                                    std::size_t first, std::size_t order) {
  std::vector<std::size_t> strip{first};
  std::vector<bool> taken = used;
  taken[first] = true;
  const Corner *before = &triangles[first][(order + 1) % 3], *last = &triangles[first][(order + 2) % 3];
  if (order >= 3) std::swap(before, last);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Corner* next = taken[i] ? nullptr : third(triangles[i], *before, *last);
    if (next == nullptr) continue;
    strip.push_back(i);
    taken[i] = true;
    before = last;
    last = next;
    i = ~std::size_t{0};  // looks from the first one again
  }
  return strip;
}

}  // namespace

StripCounts triangle_strips(std::span<const StripTriangle> triangles) {
  StripCounts out;
  std::vector<bool> used(triangles.size());
  for (std::size_t left = triangles.size(); left > 0;) {
    std::vector<std::size_t> longest;
    for (std::size_t first = 0; first < triangles.size(); ++first) {
      for (std::size_t order = 0; order < 6 && !used[first]; ++order) {
        std::vector<std::size_t> strip = strip_from(triangles, used, first, order);
        if (strip.size() > longest.size()) longest = std::move(strip);
      }
    }
    for (const std::size_t i : longest) used[i] = true;
    left -= longest.size();
    ++out.strips;
    out.vertices += static_cast<std::uint32_t>(longest.size()) + 2;
  }
  return out;
}

}  // namespace carousel::ringbus::cycle

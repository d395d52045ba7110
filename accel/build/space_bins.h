#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>

#include "accel/build/sah_build.h"

namespace carousel::accel {

/// A plane across an axis that references are cut at.
struct SpacePlane {
  int axis = 0;
  float at = 0;
};

/// Where a reference lies to a plane. A flat one on the plane lies below it.
[[gnu::always_inline]] inline bool lies_below(const BuildPrimitive& p, SpacePlane s) {
  return p.lo[s.axis] < s.at || p.hi[s.axis] <= s.at;
}
[[gnu::always_inline]] inline bool lies_above(const BuildPrimitive& p, SpacePlane s) {
  return p.hi[s.axis] > s.at;
}

/// The two sides of a division, and what they cost: the sum of half area times blocks.
struct Sides {
  Aabb below, above;
  std::size_t count_below = 0, count_above = 0;
  float cost = std::numeric_limits<float>::infinity();

  std::size_t cuts(std::size_t count) const { return count_below + count_above - count; }
  /// True if both sides hold fewer references than their parent.
  bool helps(std::size_t count) const { return count_below < count && count_above < count; }
};

struct SpaceSplit {
  SpacePlane plane;
  Sides sides;
};

inline Aabb box_of(const BuildPrimitive& p) {
  return {p.lo, p.hi};
}

/// The best of 15 planes at equal distances on each axis of `box`, around all `references`, that cut no more than
/// `most_cuts` of them. `blocks(n)` is the price of a leaf of n.
template <class Blocks>
std::optional<SpaceSplit> best_space_split(std::span<const BuildPrimitive> references, const Aabb& box,
                                           std::size_t most_cuts, const Blocks& blocks) {
  constexpr std::size_t kBins = 16;
  std::optional<SpaceSplit> best;
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = box.hi[axis] - box.lo[axis];
    if (!(extent > 0 && extent < std::numeric_limits<float>::infinity())) continue;
    std::array<float, kBins + 1> plane;  // [k]: below bin k
    for (std::size_t k = 1; k < kBins; ++k)
      plane[k] = box.lo[axis] + extent * (static_cast<float>(k) / static_cast<float>(kBins));
    std::array<Aabb, kBins> bounds;
    std::array<std::size_t, kBins> enter{}, leave{};
    const float scale = static_cast<float>(kBins) / extent;
    // The bin of a coordinate: `inside(plane)` says of each plane if it lies below what is asked for. A guess by
    // arithmetic comes first, and the planes themselves decide.
    const auto bin_of = [&](float x, const auto& is_above) {
      const float guess = (x - box.lo[axis]) * scale;
      std::size_t bin = guess > 0 ? (guess < kBins ? static_cast<std::size_t>(guess) : kBins - 1) : 0;
      while (bin > 0 && !is_above(plane[bin])) --bin;
      while (bin + 1 < kBins && is_above(plane[bin + 1])) ++bin;
      return bin;
    };
    for (const BuildPrimitive& p : references) {
      const std::size_t first = bin_of(p.lo[axis], [&](float at) { return !lies_below(p, {axis, at}); });
      const std::size_t last = bin_of(p.hi[axis], [&](float at) { return lies_above(p, {axis, at}); });
      ++enter[first];
      ++leave[last];
      for (std::size_t bin = first; bin <= last; ++bin) {
        Aabb part = box_of(p);
        if (bin > first) part.lo[axis] = plane[bin];
        if (bin < last) part.hi[axis] = plane[bin + 1];
        bounds[bin].extend(part);
      }
    }
    std::array<Aabb, kBins> above;
    Aabb sum;
    for (std::size_t k = kBins - 1; k > 0; --k) {
      sum.extend(bounds[k]);
      above[k] = sum;
    }
    Sides sides;
    sides.count_above = references.size();
    for (std::size_t k = 1; k < kBins; ++k) {
      sides.below.extend(bounds[k - 1]);
      sides.above = above[k];
      sides.count_below += enter[k - 1];
      sides.count_above -= leave[k - 1];
      if (!sides.helps(references.size()) || sides.cuts(references.size()) > most_cuts) continue;
      sides.cost =
          sides.below.half_area() * blocks(sides.count_below) + sides.above.half_area() * blocks(sides.count_above);
      if (!best || sides.cost < best->sides.cost) best = SpaceSplit{{axis, plane[k]}, sides};
    }
  }
  return best;
}

}  // namespace carousel::accel

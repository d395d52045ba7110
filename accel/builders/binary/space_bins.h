#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "accel/builders/binary/sah_build.h"

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

/// A plane and its two sides. Without one that helps, the cost is infinite.
struct Division {
  SpacePlane plane;
  Sides sides;

  bool found() const { return sides.cost < std::numeric_limits<float>::infinity(); }
};

inline Aabb box_of(const BuildPrimitive& p) {
  return {p.lo, p.hi};
}

/// 16 bins of equal width across an axis, from `least` on, and what lies in them.
class AxisBins {
 public:
  static constexpr std::size_t kBins = 16;

  AxisBins(int axis, float least, float extent)
      : axis_(axis), least_(least), scale_(static_cast<float>(kBins) / extent) {
    for (std::size_t k = 1; k < kBins; ++k)
      plane_[k] = least + extent * (static_cast<float>(k) / static_cast<float>(kBins));
  }

  /// The plane below bin `k`, which is not the first.
  float plane(std::size_t k) const { return plane_[k]; }
  /// The bin of a coordinate: `is_above(plane)` says if it lies above a plane. A guess by arithmetic comes first, and
  /// the planes themselves decide.
  template <class IsAbove>
  std::size_t bin_of(float x, const IsAbove& is_above) const {
    const float guess = (x - least_) * scale_;
    std::size_t bin = guess > 0 ? (guess < kBins ? static_cast<std::size_t>(guess) : kBins - 1) : 0;
    while (bin > 0 && !is_above(plane_[bin])) --bin;
    while (bin + 1 < kBins && is_above(plane_[bin + 1])) ++bin;
    return bin;
  }
  /// A reference that reaches from bin `first` to bin `last`.
  void count(std::size_t first, std::size_t last) {
    ++enter_[first];
    ++leave_[last];
  }
  void extend(std::size_t bin, const Aabb& part) { bounds_[bin].extend(part); }

  /// Replaces `best` by the best plane between bins with `count` references, if it costs less and cuts no more than
  /// `most_cuts` of them. `blocks(n)` is the price of a leaf of n.
  template <class Blocks>
  void offer(std::size_t count, std::size_t most_cuts, const Blocks& blocks, Division& best) const {
    std::array<Aabb, kBins> above;
    Aabb sum;
    for (std::size_t k = kBins - 1; k > 0; --k) {
      sum.extend(bounds_[k]);
      above[k] = sum;
    }
    Sides sides;
    sides.count_above = count;
    for (std::size_t k = 1; k < kBins; ++k) {
      sides.below.extend(bounds_[k - 1]);
      sides.above = above[k];
      sides.count_below += enter_[k - 1];
      sides.count_above -= leave_[k - 1];
      if (!sides.helps(count) || sides.cuts(count) > most_cuts) continue;
      sides.cost =
          sides.below.half_area() * blocks(sides.count_below) + sides.above.half_area() * blocks(sides.count_above);
      if (sides.cost < best.sides.cost) best = {{axis_, plane_[k]}, sides};
    }
  }

 private:
  int axis_;
  float least_, scale_;
  std::array<float, kBins> plane_{};
  std::array<Aabb, kBins> bounds_;
  std::array<std::size_t, kBins> enter_{}, leave_{};
};

inline bool has_planes(float extent) {
  return extent > 0 && extent < std::numeric_limits<float>::infinity();
}

/// The best of 15 planes at equal distances on each axis of `box`, around all `references`, that cut no more than
/// `most_cuts` of them. `blocks(n)` is the price of a leaf of n.
template <class Blocks>
Division best_space_division(std::span<const BuildPrimitive> references, const Aabb& box, std::size_t most_cuts,
                             const Blocks& blocks) {
  Division best;
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = box.hi[axis] - box.lo[axis];
    if (!has_planes(extent)) continue;
    AxisBins bins(axis, box.lo[axis], extent);
    for (const BuildPrimitive& p : references) {
      const std::size_t first = bins.bin_of(p.lo[axis], [&](float at) { return !lies_below(p, {axis, at}); });
      const std::size_t last = bins.bin_of(p.hi[axis], [&](float at) { return lies_above(p, {axis, at}); });
      bins.count(first, last);
      for (std::size_t bin = first; bin <= last; ++bin) {
        Aabb part = box_of(p);
        if (bin > first) part.lo[axis] = bins.plane(bin);
        if (bin < last) part.hi[axis] = bins.plane(bin + 1);
        bins.extend(bin, part);
      }
    }
    bins.offer(references.size(), most_cuts, blocks, best);
  }
  return best;
}

inline float centroid(const BuildPrimitive& p, int axis) {
  return p.lo[axis] * 0.5f + p.hi[axis] * 0.5f;
}

/// The best of 15 planes at equal distances on each axis of the centroids' box. It divides `references`, at least one,
/// into those with centroids below it and the others, and cuts none.
template <class Blocks>
Division best_object_division(std::span<const BuildPrimitive> references, const Blocks& blocks) {
  Division best;
  for (int axis = 0; axis < 3; ++axis) {
    float least = centroid(references[0], axis), most = least;
    for (const BuildPrimitive& p : references) {
      least = std::min(least, centroid(p, axis));
      most = std::max(most, centroid(p, axis));
    }
    if (!has_planes(most - least)) continue;
    AxisBins bins(axis, least, most - least);
    for (const BuildPrimitive& p : references) {
      const float at = centroid(p, axis);
      const std::size_t bin = bins.bin_of(at, [&](float plane) { return at >= plane; });
      bins.count(bin, bin);
      bins.extend(bin, box_of(p));
    }
    bins.offer(references.size(), 0, blocks, best);
  }
  return best;
}

}  // namespace carousel::accel

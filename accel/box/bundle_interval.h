// The slab test of all rays of a bundle at once (US 11308683: AnyHit, AllHit), evaluated on the ranges of their origins
// and of their rounded reciprocals with the very operations of accel/box/slab.h. Rounding is monotone, so what is
// computed here bounds the values computed for each ray, and no slack has to be proven.
//
// Along an axis the rays form two halves by the sign bit of their directions, as the slab test chooses its planes. If
// both halves have rays, a direction may be close to zero, or zero; then a half only tells if its rays are beside the
// box or behind it, and the earliest distance at which one of them may reach it.
//
// Each ray enters through the near plane of an axis no later than it leaves through the far one, rounding included,
// unless it leaves before it starts. This needs no test: compared over a bundle the two would overlap for any flat box.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "accel/box/bundle.h"
#include "accel/box/double_slab.h"
#include "accel/box/slab.h"
#include "core/types/aabb.h"

namespace carousel::accel {

/// Planes of one box, or of as many as a vector type `V` has lanes. Boxes are those of nodes: lo <= hi, or the inverted
/// infinite one of an unused lane.
template <class V>
struct BoxPlanes {
  V lo[3], hi[3];
};

template <class Real>
BoxPlanes<Real> planes_of(const Aabb& box) {
  return {{box.lo.x, box.lo.y, box.lo.z}, {box.hi.x, box.hi.y, box.hi.z}};
}

/// A bundle prepared for its tests. `Real` is the type of the slab test that it stands for: SlabRay's (float) or
/// DoubleSlabRay's. If `V` is a vector type, answers are masks and entries of its lanes.
template <class Real>
class BundleInterval {
 public:
  template <class V>
  using Mask = decltype(V{} < V{});

  /// `widening` is that of the level: far_widening().
  BundleInterval(const BundleRecord& bundle, float widening) : tmax_(bundle.tmax) {
    // The kernel's own reciprocals, stand-ins for those that overflow included.
    const float* const d_min = bundle.direction_min;
    const float* const d_max = bundle.direction_max;
    const SlabTest low({Vec3{0}, 0, {d_min[0], d_min[1], d_min[2]}, kInfinity}, widening);
    const SlabTest high({Vec3{0}, 0, {d_max[0], d_max[1], d_max[2]}, kInfinity}, widening);
    for (int axis = 0; axis < 3; ++axis) {
      const bool backwards = std::signbit(d_min[axis]), forwards = !std::signbit(d_max[axis]);
      const Pace of_low{std::fabs(low.inverse_near[axis]), std::fabs(low.inverse_far[axis])};
      const Pace of_high{std::fabs(high.inverse_near[axis]), std::fabs(high.inverse_far[axis])};
      const Real o_min = bundle.origin_min[axis], o_max = bundle.origin_max[axis];
      if (forwards) halves_[count_++] = {axis, false, o_min, o_max, of_high, backwards ? Pace{} : of_low};
      if (backwards) halves_[count_++] = {axis, true, o_max, o_min, of_low, forwards ? Pace{} : of_high};
    }
  }

  /// AnyHit fails: the slab test of every ray misses.
  template <class V>
  Mask<V> all_miss(const BoxPlanes<V>& box) const {
    const Reach<V> reach = widest(box);
    return reach.near > reach.far;
  }

  /// AllHit: the slab test hits for every ray whose range ends where the bundle's does.
  template <class V>
  Mask<V> all_hit(const BoxPlanes<V>& box) const {
    const Crossings<V> crossings = narrowest(box);
    return crossings.meet(crossings.near, tmax_);
  }

  /// Every ray whose range ends where the bundle's does meets the box, by exact arithmetic. The bundle is in double
  /// without widening: its distances, made from floats, are off by less than 2^-51 and never overflow. (One is infinite
  /// only where a direction may be zero, and then a finite exit along another axis contradicts it.)
  template <class V>
  requires std::is_same_v<Real, double> Mask<V> all_hit_exactly(const BoxPlanes<V>& box)
  const {
    const Crossings<V> crossings = narrowest(box);
    V near[3];
    for (int axis = 0; axis < 3; ++axis) near[axis] = crossings.near[axis] * (1 + 0x1p-49);
    return crossings.meet(near, tmax_);
  }

  /// No ray that hits the box enters it before this; not below 0. In double to be rounded up, as those of the slab
  /// test are.
  template <class V>
  V entry(const BoxPlanes<V>& box) const {
    return widest(box).near;
  }

 private:
  using SlabTest = std::conditional_t<std::is_same_v<Real, float>, SlabRay, DoubleSlabRay>;
  static constexpr Real kEndless = std::numeric_limits<Real>::infinity();

  template <class V>
  static V all(Real x) {
    return V{} + x;
  }
  template <class V>
  static V lesser(V a, V b) {
    return a < b ? a : b;
  }
  template <class V>
  static V greater(V a, V b) {
    return a > b ? a : b;
  }

  /// Sizes of the reciprocals of a direction; by default those of a zero.
  struct Pace {
    Real near = kEndless, far = kEndless;
  };

  /// Rays with one sign bit along one axis, and the values that the slab test computes for them.
  struct Half {
    int axis;
    bool backwards;
    Real hindmost, foremost;  ///< origins, along the direction
    Pace fastest, slowest;

    template <class V>
    V earliest_entry(const BoxPlanes<V>& box) const {
      return entry(to_near(box, foremost), fastest.near);
    }
    template <class V>
    V latest_entry(const BoxPlanes<V>& box) const {
      return entry(to_near(box, hindmost), slowest.near);
    }
    template <class V>
    V latest_exit(const BoxPlanes<V>& box) const {
      return exit(to_far(box, hindmost), slowest.far, fastest.far);
    }
    template <class V>
    V earliest_exit(const BoxPlanes<V>& box) const {
      return exit(to_far(box, foremost), fastest.far, slowest.far);
    }

   private:
    template <class V>
    V to_near(const BoxPlanes<V>& box, Real origin) const {
      return backwards ? origin - box.hi[axis] : box.lo[axis] - origin;
    }
    template <class V>
    V to_far(const BoxPlanes<V>& box, Real origin) const {
      return backwards ? origin - box.lo[axis] : box.hi[axis] - origin;
    }
    // An entry before the start of a ray counts as an entry at its start.
    template <class V>
    static V entry(V way, Real pace) {
      return way > 0 ? way * pace : V{};
    }
    // 0 * inf, on a plane and along it, is no bound.
    template <class V>
    static V exit(V way, Real ahead, Real behind) {
      const V time = way < 0 ? way * behind : way * ahead;
      return time < kEndless ? time : all<V>(kEndless);
    }
  };

  /// From the earliest entry to the latest exit of any ray that may hit.
  template <class V>
  struct Reach {
    V near, far;
  };
  template <class V>
  Reach<V> widest(const BoxPlanes<V>& box) const {
    Reach<V> reach{V{}, all<V>(tmax_)};
    for (int i = 0; i < count_;) {
      const int axis = halves_[i].axis;
      V near = all<V>(kEndless), far = all<V>(-kEndless);
      for (; i < count_ && halves_[i].axis == axis; ++i) {
        const V exit = halves_[i].latest_exit(box), entry = halves_[i].earliest_entry(box);
        const V nobody = all<V>(kEndless);
        near = lesser<V>(exit < 0 ? nobody : entry, near);  // the box may be behind all of this half
        far = greater<V>(exit, far);
      }
      reach.near = greater<V>(near, reach.near);
      reach.far = lesser<V>(far, reach.far);
    }
    return reach;
  }

  /// Along each axis, when the last ray has entered and when the first has left.
  template <class V>
  struct Crossings {
    V near[3], far[3];

    /// With entries that may be other than `near`.
    Mask<V> meet(const V* entry, Real tmax) const {
      Mask<V> met = greater<V>(greater<V>(entry[0], entry[1]), entry[2]) <= tmax;
      for (int axis = 0; axis < 3; ++axis) met &= greater<V>(entry[(axis + 1) % 3], entry[(axis + 2) % 3]) <= far[axis];
      return met;
    }
  };
  template <class V>
  Crossings<V> narrowest(const BoxPlanes<V>& box) const {
    Crossings<V> crossings;
    for (int axis = 0; axis < 3; ++axis) crossings.near[axis] = V{}, crossings.far[axis] = all<V>(kEndless);
    for (int i = 0; i < count_; ++i) {
      V& near = crossings.near[halves_[i].axis];
      V& far = crossings.far[halves_[i].axis];
      near = greater<V>(halves_[i].latest_entry(box), near);
      far = lesser<V>(halves_[i].earliest_exit(box), far);
    }
    return crossings;
  }

  Half halves_[6];  // by axis
  int count_ = 0;
  Real tmax_;
};

}  // namespace carousel::accel

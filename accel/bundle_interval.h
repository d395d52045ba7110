// The slab test of all rays of a bundle at once (US 11308683: AnyHit, AllHit), evaluated on the ranges of their origins
// and of their rounded reciprocals with the very operations of accel/slab.h. Rounding is monotone, so what is computed
// here bounds what is computed for each ray, with no slack to be proven.
//
// Along an axis the rays are taken in two halves by the sign bit of their directions, as the slab test chooses its
// planes. Where there are both, directions between may be next to zero, or zero, so that a half says only who is beside
// the box, or behind it, and how early its fastest ray may be there.
//
// That a ray enters through the near plane of an axis no later than it leaves through the far one needs no test: it
// holds for each ray by itself, rounding included, unless it leaves before it starts. Compared over a bundle the two
// would overlap wherever a box is flat.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "accel/bundle.h"
#include "accel/double_slab.h"
#include "accel/slab.h"
#include "core/aabb.h"

namespace carousel::accel {

/// A bundle as its tests want it. `Real` says which slab test it answers for: SlabRay's (float) or DoubleSlabRay's.
/// Boxes are those of nodes: lo <= hi, or the inverted infinite one of an unused lane.
template <class Real>
class BundleInterval {
 public:
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
  bool all_miss(const Aabb& box) const {
    const Reach reach = widest(box);
    return reach.near > reach.far;
  }

  /// AllHit: the slab test hits for every ray whose range ends where the bundle's does.
  bool all_hit(const Aabb& box) const {
    const Crossings crossings = narrowest(box);
    return crossings.meet(crossings.near, tmax_);
  }

  /// Every ray whose range ends where the bundle's does meets the box, by exact arithmetic. Of a bundle in double
  /// without widening: of floats, its distances are off by less than 2^-51 and never overflow. (One is infinite only
  /// where a direction may be zero, and then a finite exit along another axis contradicts it.)
  bool all_hit_exactly(const Aabb& box) const
    requires std::is_same_v<Real, double>
  {
    const Crossings crossings = narrowest(box);
    double near[3];
    for (int axis = 0; axis < 3; ++axis) near[axis] = crossings.near[axis] * (1 + 0x1p-49);
    return crossings.meet(near, tmax_);
  }

  /// No ray that hits the box enters it before this; not below 0.
  float entry(const Aabb& box) const {
    const Reach reach = widest(box);
    if constexpr (std::is_same_v<Real, double>)
      return round_up(reach.near);
    else
      return reach.near;
  }

 private:
  using SlabTest = std::conditional_t<std::is_same_v<Real, float>, SlabRay, DoubleSlabRay>;
  static constexpr Real kEndless = std::numeric_limits<Real>::infinity();

  /// Sizes of the reciprocals of a direction; by default those of a zero.
  struct Pace {
    Real near = kEndless, far = kEndless;
  };

  /// Rays with one sign bit along one axis, and what the slab test computes for them.
  struct Half {
    int axis;
    bool backwards;
    Real hindmost, foremost;   ///< origins, along the direction
    Pace fastest, slowest;

    Real earliest_entry(const Aabb& box) const {
      const Real way = to(near_plane(box), foremost);
      return way > 0 ? way * fastest.near : 0;   // before the start is as good as at the start
    }
    Real latest_entry(const Aabb& box) const {
      const Real way = to(near_plane(box), hindmost);
      return way > 0 ? way * slowest.near : 0;
    }
    // 0 * inf, on a plane and along it, bounds nothing.
    Real latest_exit(const Aabb& box) const {
      const Real way = to(far_plane(box), hindmost);
      return endless_if_nan(way * (way < 0 ? fastest.far : slowest.far));
    }
    Real earliest_exit(const Aabb& box) const {
      const Real way = to(far_plane(box), foremost);
      return endless_if_nan(way * (way < 0 ? slowest.far : fastest.far));
    }

   private:
    Real near_plane(const Aabb& box) const { return backwards ? box.hi[axis] : box.lo[axis]; }
    Real far_plane(const Aabb& box) const { return backwards ? box.lo[axis] : box.hi[axis]; }
    Real to(Real plane, Real origin) const { return backwards ? origin - plane : plane - origin; }
    static Real endless_if_nan(Real x) { return x < kEndless ? x : kEndless; }
  };

  /// From the earliest entry to the latest exit of any ray that may hit.
  struct Reach {
    Real near, far;
  };
  Reach widest(const Aabb& box) const {
    Reach reach{0, tmax_};
    for (int i = 0; i < count_;) {
      const int axis = halves_[i].axis;
      Real near = kEndless, far = -kEndless;
      for (; i < count_ && halves_[i].axis == axis; ++i) {
        const Real exit = halves_[i].latest_exit(box);
        if (exit < 0) continue;   // the box is behind all of this half
        const Real entry = halves_[i].earliest_entry(box);
        near = entry < near ? entry : near;
        far = exit > far ? exit : far;
      }
      reach.near = near > reach.near ? near : reach.near;
      reach.far = far < reach.far ? far : reach.far;
    }
    return reach;
  }

  /// Along each axis, when the last ray has entered and when the first has left.
  struct Crossings {
    Real near[3] = {0, 0, 0}, far[3] = {kEndless, kEndless, kEndless};

    /// With entries that may be other than `near`.
    bool meet(const Real* entry, Real tmax) const {
      for (int axis = 0; axis < 3; ++axis) {
        const Real one = entry[(axis + 1) % 3], other = entry[(axis + 2) % 3];
        if (!(entry[axis] <= tmax) || !((one > other ? one : other) <= far[axis])) return false;
      }
      return true;
    }
  };
  Crossings narrowest(const Aabb& box) const {
    Crossings crossings;
    for (int i = 0; i < count_; ++i) {
      Real& near = crossings.near[halves_[i].axis];
      Real& far = crossings.far[halves_[i].axis];
      const Real entry = halves_[i].latest_entry(box), exit = halves_[i].earliest_exit(box);
      near = entry > near ? entry : near;
      far = exit < far ? exit : far;
    }
    return crossings;
  }

  Half halves_[6];   // by axis
  int count_ = 0;
  Real tmax_;
};

}  // namespace carousel::accel

// Silhouette of a box against a bundle of rays (US 11308683, "Intersection testing in a ray tracing system using ray
// bundle vectors"), for directions of one octant, mirrored here so that none is negative. An edge of the silhouette is
// the line where the near plane of one axis i meets the far plane of another j. A ray passes outside of it if it
// reaches the far plane before the near one: (lo_i - o_i) / d_i > (hi_j - o_j) / d_j, or, without division, (lo_i -
// o_i) d_j > (hi_j - o_j) d_i. At the ends of the ranges of origins and directions this holds for all rays. Rays that
// start beyond a far plane miss, and so do those whose range ends before a near one; no edge tells these.
//
// A claimed miss must also be a miss of the computed slab test. Its distances (p - o) * (1 / d) have three roundings,
// four if the reciprocal is widened, so one that is more than 8 u greater than another times the widening (u = 2^-24;
// 2^-53 for the test in double) is greater in the slab test as well. For AllHit the widening, if there is any, covers
// that. Here differences are rounded in double, by less than 2^-51 of them, and products of two floats are exact or
// rounded likewise.
//
// All errors are relative as long as nothing overflows or underflows: reciprocals of [kSlow, kFast] are normal floats,
// and so are distances in it. If a range leaves it, the edge makes no claim.
#include "accel/box/bundle_silhouette.h"

#include <algorithm>
#include <cmath>

#include "accel/box/slab.h"

namespace carousel::accel {
namespace {

constexpr double kSlow = 0x1p-100, kFast = 0x1p100;
constexpr double kFloatRounding = 1 + 8 * 0x1p-24, kDoubleRounding = 1 + 0x1p-48;

// No distance over such a way at this pace or a faster one overflows, nor does its reciprocal.
bool in_float_range(double way, double slowest) {
  return slowest >= kSlow && way <= kFast * std::min(1.0, slowest);
}

}  // namespace

bool BundleSilhouette::applies(const BundleRecord& bundle) {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = bundle.direction_min[axis], high = bundle.direction_max[axis];
    if (std::signbit(low) != std::signbit(high)) return false;
    const float fastest = std::max(std::fabs(low), std::fabs(high));
    if (fastest != 0 && !(fastest >= kSlow && fastest <= kFast)) return false;
  }
  return bundle.tmax >= kSlow;
}

BundleSilhouette::BundleSilhouette(const BundleRecord& bundle, BoxLevel level, BundlesConfig::Edges edges)
    : tmax_(bundle.tmax),
      rounding_(level == BoxLevel::kDouble ? kDoubleRounding : kFloatRounding),
      missed_by_(far_widening(level) * rounding_),
      hit_by_(level == BoxLevel::kPlain ? kFloatRounding : kDoubleRounding),
      one_after_another_(edges == BundlesConfig::Edges::kSerial) {
  for (int axis = 0; axis < 3; ++axis) {
    const double o_min = bundle.origin_min[axis], o_max = bundle.origin_max[axis];
    const double low = bundle.direction_min[axis], high = bundle.direction_max[axis];
    if (std::signbit(low))
      axes_[axis] = {true, o_max, o_min, -high, -low};
    else
      axes_[axis] = {false, o_min, o_max, low, high};
  }
}

BundleSilhouette::Ways BundleSilhouette::ways(const Aabb& box) const {
  Ways w;
  int seen = 0;  // faces, from where the hindmost rays start
  for (int i = 0; i < 3; ++i) {
    const Axis& axis = axes_[i];
    const double lo = box.lo[i], hi = box.hi[i];
    w.to_near_least[i] = axis.backwards ? axis.foremost - hi : lo - axis.foremost;
    w.to_near_most[i] = axis.backwards ? axis.hindmost - hi : lo - axis.hindmost;
    w.to_far_least[i] = axis.backwards ? axis.foremost - lo : hi - axis.foremost;
    w.to_far_most[i] = axis.backwards ? axis.hindmost - lo : hi - axis.hindmost;
    seen += w.to_near_most[i] > 0;
  }
  w.edges = seen == 0 ? 0 : seen == 1 ? 4 : 6;
  return w;
}

bool BundleSilhouette::all_miss(const Aabb& box, unsigned& edges) const {
  const Ways w = ways(box);
  for (int i = 0; i < 3; ++i) {
    if (w.to_far_most[i] < 0 && -w.to_far_most[i] > kSlow * axes_[i].fastest) return true;
    const double way = w.to_near_least[i];
    if (way > 0 && way > kSlow * axes_[i].fastest && way > tmax_ * axes_[i].fastest * rounding_) return true;
  }
  unsigned tested = 0;
  bool missed = false;
  for (int i = 0; i < 3; ++i) {
    if (!(w.to_near_most[i] > 0)) continue;  // its near plane is behind them: no edge of it decides
    const bool measurable = w.to_near_least[i] > 0 && w.to_near_least[i] > kSlow * axes_[i].fastest;
    for (int j = 0; j < 3; ++j) {
      if (j == i) continue;
      ++tested;
      if (!measurable || !in_float_range(w.to_far_most[j], axes_[j].slowest)) continue;
      if (!(w.to_near_least[i] * axes_[j].slowest > w.to_far_most[j] * axes_[i].fastest * missed_by_)) continue;
      missed = true;
      if (!one_after_another_) continue;
      edges += tested;
      return true;
    }
  }
  edges += w.edges;
  return missed;
}

bool BundleSilhouette::all_hit(const Aabb& box, unsigned& edges) const {
  const Ways w = ways(box);
  for (int i = 0; i < 3; ++i) {
    if (w.to_far_least[i] < 0) return false;
    if (!(w.to_near_most[i] > 0)) continue;
    if (!in_float_range(w.to_near_most[i], axes_[i].slowest)) return false;
    if (w.to_near_most[i] * rounding_ > tmax_ * axes_[i].slowest) return false;
  }
  unsigned tested = 0;
  bool hit = true;
  for (int i = 0; i < 3; ++i) {
    if (!(w.to_near_most[i] > 0)) continue;
    for (int j = 0; j < 3; ++j) {
      if (j == i) continue;
      ++tested;
      const bool inside = w.to_near_most[i] * axes_[j].fastest * hit_by_ <= w.to_far_least[j] * axes_[i].slowest &&
                          w.to_far_least[j] >= kSlow * axes_[j].fastest;
      hit &= inside;
      if (inside || !one_after_another_) continue;
      edges += tested;
      return false;
    }
  }
  edges += w.edges;
  return hit;
}

}  // namespace carousel::accel

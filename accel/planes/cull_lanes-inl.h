// Culls the children of a node by their planes, all at once, in either order of planes and box.
// accel/planes/cull_plane_clip.h proves that no child is culled in which the triangle kernel has a hit.
//
// In both orders the line is clipped by the planes and by the box, so the same children are culled: the last bounds are
// the same. With planes first a child that the planes alone cull needs no box test; for the others the box test clips
// the part of the line that the planes have left.
//
// Each lane is one child. Operations are the same for every width of registers, none of them contracted, so the answers
// are. Comparisons are false for NaN, which cuts nothing off.
#if defined(CAROUSEL_ACCEL_CULL_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_CULL_LANES_INL_H_
#undef CAROUSEL_ACCEL_CULL_LANES_INL_H_
#else
#define CAROUSEL_ACCEL_CULL_LANES_INL_H_
#endif

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <hwy/highway.h>

#include "accel/box/slab-inl.h"
#include "accel/planes/count_culled.h"
#include "accel/planes/cull_plane_clip.h"
#include "accel/structure/accel.h"
#include "accel/structure/cull_plane.h"
#include "core/numeric/rounding.h"
#include "core/statistics/cull_counts.h"
#include "core/statistics/intersection_counts.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// The number of planes of each child, and of those before it.
struct LanePlaneCounts {
  alignas(8) std::uint8_t own[kMaxWidth], before[kMaxWidth];

  HWY_INLINE explicit LanePlaneCounts(std::uint32_t nibbles) {
    std::uint64_t bytes = nibbles;
    bytes = (bytes | bytes << 16) & 0x0000ffff0000ffffull;
    bytes = (bytes | bytes << 8) & 0x00ff00ff00ff00ffull;
    bytes = (bytes | bytes << 4) & 0x0f0f0f0f0f0f0f0full;
    const std::uint64_t sums = bytes * 0x0101010101010100ull;  // at most 56
    std::memcpy(own, &bytes, sizeof(own));
    std::memcpy(before, &sums, sizeof(before));
  }
};

#if HWY_TARGET != HWY_SCALAR
/// Four numbers at `low` and, where a register has room for eight, those at `high` in its upper half.
template <class D>
HWY_INLINE hn::Vec<D> load_halves(D d, const CullPlane& low, const CullPlane& high) {
  const hn::CappedTag<float, 4> d4;
  const auto load = [&](const CullPlane& p) HWY_ATTR { return hn::LoadU(d4, reinterpret_cast<const float*>(&p)); };
  if constexpr (hn::MaxLanes(d) == 8)
    return hn::Combine(d, load(high), load(low));
  else
    return load(low);
}
#endif

/// A plane of each lane.
struct PlaneLanes {
  using Tag = hn::CappedTag<float, kMaxWidth>;
  hn::Vec<Tag> x, y, z, distance;

  /// `at(lane)` is the plane of a lane. Whole planes are loaded and transposed: gathering is slower on many machines.
  template <class At>
  HWY_INLINE explicit PlaneLanes(const At& at) {
    const Tag d;
#if HWY_TARGET == HWY_SCALAR
    const CullPlane& plane = at(0);
    x = hn::Set(d, plane.normal[0]), y = hn::Set(d, plane.normal[1]), z = hn::Set(d, plane.normal[2]);
    distance = hn::Set(d, plane.distance);
#else
    constexpr std::size_t kHigh = hn::MaxLanes(Tag()) == 8 ? 4 : 0;
    const auto row = [&](std::size_t lane) HWY_ATTR { return load_halves(d, at(lane), at(lane + kHigh)); };
    const auto a = row(0), b = row(1), c = row(2), e = row(3);
    const hn::RepartitionToWide<Tag> wide;
    const auto xy_ab = hn::BitCast(wide, hn::InterleaveLower(d, a, b)),
               zd_ab = hn::BitCast(wide, hn::InterleaveUpper(d, a, b));
    const auto xy_ce = hn::BitCast(wide, hn::InterleaveLower(d, c, e)),
               zd_ce = hn::BitCast(wide, hn::InterleaveUpper(d, c, e));
    x = hn::BitCast(d, hn::InterleaveLower(wide, xy_ab, xy_ce)),
    y = hn::BitCast(d, hn::InterleaveUpper(wide, xy_ab, xy_ce));
    z = hn::BitCast(d, hn::InterleaveLower(wide, zd_ab, zd_ce));
    distance = hn::BitCast(d, hn::InterleaveUpper(wide, zd_ab, zd_ce));
#endif
  }
};

HWY_INLINE std::uint32_t bits_of(hn::Mask<PlaneLanes::Tag> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(PlaneLanes::Tag(), mask, bits);
  return bits[0];
}

/// The part of a ray's line that planes and box leave, for some children.
class CutLines {
 public:
  using Tag = PlaneLanes::Tag;
  using V = hn::Vec<Tag>;
  using M = hn::Mask<Tag>;

  /// Reads the lanes from `first` on.
  HWY_INLINE CutLines(const Node& node, std::size_t first, const SlabRay& ray, float margins) : ray_(ray) {
    const Tag d;
    const auto half = hn::Set(d, 0.5f);
    V reach = hn::Zero(d);
    V* const from[3] = {&from_x_, &from_y_, &from_z_};
    V* const lo[3] = {&lo_x_, &lo_y_, &lo_z_};
    V* const hi[3] = {&hi_x_, &hi_y_, &hi_z_};
    for (int axis = 0; axis < 3; ++axis) {
      const V l = hn::Load(d, node.plane[axis] + first), h = hn::Load(d, node.plane[axis + 3] + first);
      const V origin = hn::Set(d, ray.origin[axis]);
      *lo[axis] = hn::Sub(l, origin);
      *hi[axis] = hn::Sub(h, origin);
      *from[axis] = hn::Sub(origin, hn::Add(hn::Mul(half, l), hn::Mul(half, h)));  // plane_centre()
      reach = keep_max(hn::Abs(*lo[axis]), reach);
      reach = keep_max(hn::Abs(*hi[axis]), reach);
    }
    margin_ = hn::Mul(hn::Set(d, margins),
                      hn::Add(hn::Mul(hn::Set(d, node.margin_per_reach), reach), hn::Set(d, node.least_margin)));
    entry_ = hn::Set(d, -kInfinity);
    exit_ = hn::Set(d, kInfinity);
  }

  /// By the box, each face moved out.
  HWY_INLINE void cut_by_box() {
    cut_by_slab(0, lo_x_, hi_x_);
    cut_by_slab(1, lo_y_, hi_y_);
    cut_by_slab(2, lo_z_, hi_z_);
  }

  /// By a plane of each lane in `lanes`; other lanes' planes have no meaning.
  HWY_INLINE void cut_by_plane(M lanes, const PlaneLanes& p, const Vec3& direction) {
    const Tag d;
    const V height =
        hn::Sub(hn::Add(hn::Add(hn::Mul(p.x, from_x_), hn::Mul(p.y, from_y_)), hn::Mul(p.z, from_z_)), p.distance);
    const V outside = hn::Sub(height, margin_);  // distance of the origin beyond the plane
    const V along = hn::Add(hn::Add(hn::Mul(p.x, hn::Set(d, direction.x)), hn::Mul(p.y, hn::Set(d, direction.y))),
                            hn::Mul(p.z, hn::Set(d, direction.z)));
    const V zero = hn::Zero(d), at = hn::Div(outside, hn::Neg(along));
    // Seen from the front the line comes in; from the back it goes out, behind the origin or not.
    const M in = hn::And(lanes, hn::And(hn::Lt(along, zero), hn::Gt(at, entry_)));
    const M out = hn::And(lanes, hn::And(hn::Gt(along, zero), hn::Lt(at, exit_)));
    const M beside = hn::And(lanes, hn::And(hn::Eq(along, zero), hn::Gt(outside, zero)));
    entry_ = hn::IfThenElse(beside, hn::Set(d, kInfinity), hn::IfThenElse(in, at, entry_));
    exit_ = hn::IfThenElse(beside, hn::Set(d, -kInfinity), hn::IfThenElse(out, at, exit_));
  }

  /// By a sphere of each lane in `lanes`; `sphere(lane)` is that of a lane. In double, whose rounding is nothing beside
  /// the margin: a point of the line that is within 11 u of the reach of the sphere (6 u along each axis, see
  /// cull_plane_clip.h) is within a sphere whose radius is larger by 32 u.
  template <class At>
  HWY_INLINE void cut_by_sphere(M lanes, const At& sphere, const Vec3& direction) {
    const Tag d;
    alignas(32) float margin[kMaxWidth], entry[kMaxWidth], exit[kMaxWidth];
    hn::Store(margin_, d, margin);
    hn::Store(entry_, d, entry);
    hn::Store(exit_, d, exit);
    const DVec3 by(direction);
    const double length2 = by.x * by.x + by.y * by.y + by.z * by.z;
    for (std::uint32_t left = bits_of(lanes); left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const CullPlane& s = sphere(lane);
      const double radius = double{s.distance} + double{margin[lane]};
      const DVec3 from(double{ray_.origin[0]} - double{s.normal[0]}, double{ray_.origin[1]} - double{s.normal[1]},
                       double{ray_.origin[2]} - double{s.normal[2]});
      const double middle = -(from.x * by.x + from.y * by.y + from.z * by.z) / length2;
      const DVec3 off(from.x + middle * by.x, from.y + middle * by.y, from.z + middle * by.z);
      const double half2 = radius * radius - (off.x * off.x + off.y * off.y + off.z * off.z);
      if (half2 < 0) entry[lane] = kInfinity;
      if (!(half2 >= 0)) continue;
      const double half = std::sqrt(half2 / length2);
      entry[lane] = std::fmax(rounded_down(middle - half), entry[lane]);
      exit[lane] = std::fmin(rounded_up(middle + half), exit[lane]);
    }
    entry_ = hn::Load(d, entry);
    exit_ = hn::Load(d, exit);
  }

  /// Lanes in which the line misses everything that stands in the child.
  HWY_INLINE M empty() const { return hn::Gt(entry_, exit_); }

 private:
  HWY_INLINE void cut_by_slab(int axis, V lo, V hi) {
    const Tag d;
    const float inverse = ray_.inverse_near[axis];
    // Along the faces, or so nearly that the reciprocal overflows: the box test sees to it.
    if (!(std::fabs(inverse) < std::numeric_limits<float>::max())) return;
    const V first = inverse < 0.0f ? hn::Add(hi, margin_) : hn::Sub(lo, margin_);
    const V last = inverse < 0.0f ? hn::Sub(lo, margin_) : hn::Add(hi, margin_);
    entry_ = keep_max(hn::Mul(first, hn::Set(d, inverse)), entry_);
    exit_ = keep_min(hn::Mul(last, hn::Set(d, inverse)), exit_);
  }

  const SlabRay& ray_;
  V lo_x_, lo_y_, lo_z_, hi_x_, hi_y_, hi_z_, from_x_, from_y_, from_z_, margin_, entry_, exit_;
};

/// Cuts the lines of `lanes`, from `first` on, by their planes one after another, until nothing is left of one. Returns
/// the planes looked at.
HWY_INLINE std::uint64_t cut_by_planes(CutLines& lines, const LanePlaneCounts& counts, std::size_t first,
                                       const CullPlane* planes, CutLines::M lanes, const Vec3& direction) {
  const CutLines::Tag d;
  const hn::RebindToSigned<CutLines::Tag> di;
  const hn::Rebind<std::uint8_t, CutLines::Tag> d8;
  const auto count = hn::PromoteTo(di, hn::Load(d8, counts.own + first));
  std::uint64_t tested = 0;
  for (std::int32_t k = 0; k < kMaxCullPlanes; ++k) {
    const auto some = hn::RebindMask(d, hn::Gt(count, hn::Set(di, k)));
    const CutLines::M active = hn::And(lanes, hn::AndNot(lines.empty(), some));
    if (hn::AllFalse(d, active)) break;
    tested += hn::CountTrue(d, active);
    const PlaneLanes turn([&](std::size_t lane) HWY_ATTR -> const CullPlane& {
      const int before = counts.before[first + lane];
      return planes[k < counts.own[first + lane] ? before + k : 0];  // a lane without another: any
    });
    lines.cut_by_plane(active, turn, direction);
  }
  return tested;
}

/// Cuts the lines of `lanes`, from `first` on, by the sphere of each. Returns the spheres looked at.
HWY_INLINE std::uint64_t cut_by_spheres(CutLines& lines, const LanePlaneCounts& counts, std::size_t first,
                                        const CullPlane* spheres, CutLines::M lanes, const Vec3& direction) {
  const CutLines::M active = hn::AndNot(lines.empty(), lanes);
  lines.cut_by_sphere(
      active,
      [&](int lane) -> const CullPlane& { return spheres[counts.before[first + static_cast<std::size_t>(lane)]]; },
      direction);
  return hn::CountTrue(CutLines::Tag(), active);
}

HWY_INLINE CutLines::M mask_of(std::uint32_t bits) {
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits)};
  return hn::LoadMaskBits(CutLines::Tag(), bytes);
}

/// Returns the child lanes of `mask`, whose boxes were hit, that no plane shows to be missed. With accel.planes_first
/// the planes of all `lanes` are tested, and box tests that are not needed are taken from counts.box.
HWY_NOINLINE std::uint32_t cull_lanes(const Accel& accel, const Node& node, const SlabRay& ray, const Vec3& direction,
                                      std::uint32_t lanes, std::uint32_t mask, IntersectionCounts& counts,
                                      CullCounts* culls) {
  constexpr std::size_t kLanes = hn::MaxLanes(CutLines::Tag());
  const LanePlaneCounts planes(node.plane_counts);
  const CullPlane* const first_plane = accel.planes.data() + node.first_plane;
  const float margins = covered_by_margin(direction, node.above_instances) ? 1.0f : kInfinity;
  std::uint32_t with_planes = 0;
  for (int lane = 0; lane < kMaxWidth; ++lane) with_planes |= std::uint32_t{planes.own[lane] != 0} << lane;
  const std::uint32_t wanted = with_planes & (accel.planes_first ? lanes : mask);
  CullLevel level;
  std::uint32_t culled = 0;
  for (std::size_t first = 0; first < kMaxWidth; first += kLanes) {
    const std::uint32_t here = wanted >> first & ((1u << kLanes) - 1);
    if (here == 0) continue;
    CutLines lines(node, first, ray, margins);
    if (!accel.planes_first) lines.cut_by_box();
    level.plane_tests += (accel.second_spheres ? cut_by_spheres : cut_by_planes)(lines, planes, first, first_plane,
                                                                                 mask_of(here), direction);
    if (accel.planes_first) {
      level.boxes += hn::CountTrue(CutLines::Tag(), hn::And(lines.empty(), mask_of(here)));
      lines.cut_by_box();
    }
    culled |= (bits_of(lines.empty()) & here) << first;
  }
  culled &= mask;
  counts.plane += level.plane_tests;
  counts.box -= level.boxes;
  counts.culled += hwy::PopCount(culled);
  if (culls != nullptr) {
    level.children = hwy::PopCount(wanted);
    for (std::uint32_t left = culled; left != 0; left &= left - 1)
      count_culled(accel, node.child[std::countr_zero(left)], level);
    culls->at(node.above_instances, node.depth) += level;
  }
  return mask & ~culled;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

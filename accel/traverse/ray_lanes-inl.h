// Rays in lanes: a box, or a triangle, against as many rays as a register holds.
#if defined(CAROUSEL_ACCEL_RAY_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_RAY_LANES_INL_H_
#undef CAROUSEL_ACCEL_RAY_LANES_INL_H_
#else
#define CAROUSEL_ACCEL_RAY_LANES_INL_H_
#endif

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/highway.h>

#include "accel/box/slab-inl.h"
#include "accel/primitive/local_ray.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::uint32_t kMostRayLanes = 16;

/// The part of a ray that tests in lists read, in one cache line. Fields are read four at a time.
struct alignas(64) StreamRay {
  float origin[3], tmin;
  float near[3];
  float tmax;  ///< the hit's distance, or -inf once no hit is wanted any more
  float far[3];
  float sx, sy, sz;      ///< of the watertight test, as are these
  std::uint32_t kx, ky;  ///< times 4

  HWY_INLINE StreamRay(const LocalRay<SlabRay>& ray, float end) : tmin(ray.slab.tmin), tmax(end) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = ray.slab.origin[axis];
      near[axis] = ray.slab.inverse_near[axis];
      far[axis] = ray.slab.inverse_far[axis];
    }
    // Of another level's test these are not read.
    const WatertightRay<float>& shear = ray.triangle.watertight;
    sx = shear.sx, sy = shear.sy, sz = shear.sz;
    kx = 4 * static_cast<std::uint32_t>(shear.kx), ky = 4 * static_cast<std::uint32_t>(shear.ky);
  }
};
static_assert(sizeof(StreamRay) == 64);

#if HWY_TARGET != HWY_SCALAR
using RayTag = hn::CappedTag<float, kMostRayLanes>;
using RayVec = hn::Vec<RayTag>;
using RayMask = hn::Mask<RayTag>;
inline constexpr std::size_t kRayLanes = hn::MaxLanes(RayTag());

/// Four fields, from `first` on, of every fourth ray.
template <class D, class Row>
HWY_INLINE hn::Vec<D> load_rows(D d, const Row* const* rays, std::size_t first) {
  if constexpr (hn::MaxLanes(d) > 4) {
    const hn::Half<D> half;
    return hn::Combine(d, load_rows(half, rays + hn::MaxLanes(half), first), load_rows(half, rays, first));
  } else {
    return hn::Load(d, reinterpret_cast<const float*>(rays[0]) + first);
  }
}

/// Four fields of the rays of a register.
struct FourFields {
  RayVec field[4];

  /// `rays` has kRayLanes; the fields begin at the `first`. Whole rows are loaded and transposed.
  template <class Row>
  HWY_INLINE FourFields(const Row* const* rays, std::size_t first) {
    const RayTag d;
    const hn::Repartition<std::uint64_t, RayTag> d64;
    const auto row = [&](std::size_t i) HWY_ATTR { return load_rows(d, rays + i, first); };
    const auto a = row(0), b = row(1), c = row(2), e = row(3);
    const auto in_pairs = [&](auto v) HWY_ATTR { return hn::BitCast(d64, v); };
    const auto low_ab = in_pairs(hn::InterleaveLower(d, a, b)), low_ce = in_pairs(hn::InterleaveLower(d, c, e));
    const auto high_ab = in_pairs(hn::InterleaveUpper(d, a, b)), high_ce = in_pairs(hn::InterleaveUpper(d, c, e));
    field[0] = hn::BitCast(d, hn::InterleaveLower(d64, low_ab, low_ce));
    field[1] = hn::BitCast(d, hn::InterleaveUpper(d64, low_ab, low_ce));
    field[2] = hn::BitCast(d, hn::InterleaveLower(d64, high_ab, high_ce));
    field[3] = hn::BitCast(d, hn::InterleaveUpper(d64, high_ab, high_ce));
  }
};

HWY_INLINE std::uint32_t ray_bits(RayMask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(RayTag(), mask, bytes);
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8;
}

/// The lanes whose sign bit is set.
HWY_INLINE RayMask is_negative(RayVec v) {
  const hn::RebindToUnsigned<RayTag> du;
  return hn::RebindMask(RayTag(), hn::TestBit(hn::BitCast(du, v), hn::Set(du, std::uint32_t{1} << 31)));
}

/// Rays for tests of boxes.
struct BoxLanes {
  RayVec origin[3], near[3], far[3], tmin, tmax;
  RayMask backwards[3];

  /// As SlabRay does.
  HWY_INLINE BoxLanes(const RayRecord* const* rays, float widening) {
    const FourFields a(rays, 0), b(rays, 4), c(rays, 8);
    const RayTag d;
    const auto zero = hn::Zero(d), largest = hn::Set(d, std::numeric_limits<float>::max());
    for (int axis = 0; axis < 3; ++axis) {
      const auto direction = b.field[axis], inverse = hn::Div(hn::Set(d, 1.0f), direction);
      origin[axis] = a.field[axis];
      far[axis] = hn::Mul(inverse, hn::Set(d, widening));
      const auto overflow = hn::AndNot(hn::Eq(direction, zero), hn::Gt(hn::Abs(inverse), largest));
      near[axis] = hn::IfThenElse(overflow, hn::CopySignToAbs(largest, direction), inverse);
      backwards[axis] = is_negative(direction);
    }
    tmin = a.field[3], tmax = c.field[0];
  }

  HWY_INLINE explicit BoxLanes(const StreamRay* const* rays) {
    const FourFields a(rays, 0), b(rays, 4), c(rays, 8);
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = a.field[axis], near[axis] = b.field[axis], far[axis] = c.field[axis];
      backwards[axis] = is_negative(near[axis]);
    }
    tmin = a.field[3], tmax = b.field[3];
  }

  /// Operation for operation what slab_node() does with the box of `child`.
  HWY_INLINE RayMask meet(const Node& node, std::size_t child, RayVec& entry) const {
    const RayTag d;
    auto nearest = tmin, farthest = tmax;
    for (int axis = 0; axis < 3; ++axis) {
      const auto lo = hn::Set(d, node.plane[axis][child]), hi = hn::Set(d, node.plane[axis + 3][child]);
      const auto front = hn::IfThenElse(backwards[axis], hi, lo), back = hn::IfThenElse(backwards[axis], lo, hi);
      nearest = keep_max(hn::Mul(hn::Sub(front, origin[axis]), near[axis]), nearest);
      farthest = keep_min(hn::Mul(hn::Sub(back, origin[axis]), far[axis]), farthest);
    }
    entry = nearest;
    return hn::Le(nearest, farthest);
  }
};

#if HWY_MAX_BYTES >= 64
/// Rays for watertight tests of triangles, where a register holds sixteen.
class TriangleLanes {
 public:
  HWY_INLINE explicit TriangleLanes(const StreamRay* const* rays) {
    const FourFields a(rays, 0), b(rays, 8), c(rays, 12);
    const hn::RebindToUnsigned<RayTag> du;
    sx_ = b.field[3], sy_ = c.field[0];
    axis_[0] = hn::BitCast(du, c.field[2]), axis_[1] = hn::BitCast(du, c.field[3]);
    axis_[2] = hn::Sub(hn::Set(du, 12), hn::Add(axis_[0], axis_[1]));
    for (int k = 0; k < 3; ++k) origin_[k] = select(k, a.field[0], a.field[1], a.field[2]);
  }

  /// The rays that watertight_lanes() may find to cross triangle `l`. Edge values are the same here. One that is not 0
  /// has the sign of the exact one, since rounding keeps the order of the products; settled in double it has the same.
  HWY_INLINE RayMask may_cross(const TriangleBlock& block, std::size_t l) const {
    const RayTag d;
    RayVec x[3], y[3];
    for (int vertex = 0; vertex < 3; ++vertex) {
      const float* const corner = &block.vertex[vertex][0][0];
      const auto z = from_origin(corner, l, 2);
      x[vertex] = hn::Sub(from_origin(corner, l, 0), hn::Mul(sx_, z));
      y[vertex] = hn::Sub(from_origin(corner, l, 1), hn::Mul(sy_, z));
    }
    const auto u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
    const auto v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
    const auto w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
    const auto zero = hn::Zero(d);
    const auto negative = hn::Or(hn::Lt(u, zero), hn::Or(hn::Lt(v, zero), hn::Lt(w, zero)));
    const auto positive = hn::Or(hn::Gt(u, zero), hn::Or(hn::Gt(v, zero), hn::Gt(w, zero)));
    return hn::Not(hn::And(negative, positive));
  }

 private:
  HWY_INLINE RayVec select(int k, RayVec x, RayVec y, RayVec z) const {
    const hn::RebindToUnsigned<RayTag> du;
    const auto is = [&](std::uint32_t axis)
                        HWY_ATTR { return hn::RebindMask(RayTag(), hn::Eq(axis_[k], hn::Set(du, 4 * axis))); };
    return hn::IfThenElse(is(0), x, hn::IfThenElse(is(1), y, z));
  }

  /// The coordinate along the rays' axis `k` of triangle `l`'s corner, from the rays' origins.
  HWY_INLINE RayVec from_origin(const float* corner, std::size_t l, int k) const {
    const RayTag d;
    static_assert(sizeof(TriangleBlock::primitive) >= 4 * sizeof(float), "sixteen floats from each corner on");
    const hn::RebindToUnsigned<RayTag> du;
    const auto lanes = hn::Add(axis_[k], hn::Set(du, static_cast<std::uint32_t>(l)));
    return hn::Sub(hn::TableLookupLanes(hn::LoadU(d, corner), hn::IndicesFromVec(d, lanes)), origin_[k]);
  }

  RayVec sx_, sy_, origin_[3];
  hn::Vec<hn::RebindToUnsigned<RayTag>> axis_[3];  // kx, ky and kz, times 4
};
#endif
#endif

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// The slab test (Kay, Kajiya 1986), conservative as in Ize 2013, "Robust BVH ray traversal". Near and far
// planes are chosen by the sign bit of the direction and updates keep the old value when a comparison is
// false, so the NaN of 0 * inf (origin on a plane, direction along it) never drops a box.
//
// Per-target include guard: Highway compiles this once a SIMD target.
#if defined(CAROUSEL_ACCEL_SLAB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_SLAB_INL_H_
#undef CAROUSEL_ACCEL_SLAB_INL_H_
#else
#define CAROUSEL_ACCEL_SLAB_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/box/slab.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// a > b ? a : b and a < b ? a : b. On x86 the instruction behind Max and Min does exactly this, and keeps b
// if the comparison is false or unordered; on other machines it is spelled out.
template <class V>
HWY_INLINE V keep_max(V a, V b) {
#if HWY_ARCH_X86
  return hn::Max(a, b);
#else
  return hn::IfThenElse(hn::Gt(a, b), a, b);
#endif
}
template <class V>
HWY_INLINE V keep_min(V a, V b) {
#if HWY_ARCH_X86
  return hn::Min(a, b);
#else
  return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

/// A SlabRay in registers: one for a whole traversal.
struct SlabLanes {
  using Tag = hn::CappedTag<float, kMaxWidth>;
  using Vec = hn::Vec<Tag>;
  Vec origin_x, origin_y, origin_z, near_x, near_y, near_z, far_x, far_y, far_z, tmin;
  std::uint32_t near_row[3], far_row[3];

  HWY_INLINE explicit SlabLanes(const SlabRay& ray) {
    const Tag d;
    origin_x = hn::Set(d, ray.origin[0]), origin_y = hn::Set(d, ray.origin[1]), origin_z = hn::Set(d, ray.origin[2]);
    near_x = hn::Set(d, ray.inverse_near[0]), near_y = hn::Set(d, ray.inverse_near[1]);
    near_z = hn::Set(d, ray.inverse_near[2]), far_x = hn::Set(d, ray.inverse_far[0]);
    far_y = hn::Set(d, ray.inverse_far[1]), far_z = hn::Set(d, ray.inverse_far[2]);
    tmin = hn::Set(d, ray.tmin);
    for (int axis = 0; axis < 3; ++axis) {
      near_row[axis] = ray.near_row[axis];
      far_row[axis] = ray.far_row[axis];
    }
  }
};

HWY_INLINE SlabLanes in_registers(const SlabRay& ray) {
  return SlabLanes(ray);
}

/// One ray against the eight boxes of a node: bit l of the result when lane l is entered before tmax; all
/// eight entries (never below tmin) are stored. `nearest`, unless null, is lowered to the entries of lanes hit.
HWY_INLINE std::uint32_t slab_node(const Node& node, const SlabLanes& ray, float tmax, float* HWY_RESTRICT entry,
                                   float* HWY_RESTRICT nearest = nullptr) {
  const SlabLanes::Tag d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const char* const planes = reinterpret_cast<const char*>(&node.plane[0][0]);
  const auto plane = [&](std::uint32_t row, std::size_t i)
                         HWY_ATTR { return hn::Load(d, reinterpret_cast<const float*>(planes + row) + i); };
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kMaxWidth; i += kLanes) {
    auto near = ray.tmin;
    auto far = hn::Set(d, tmax);
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[0], i), ray.origin_x), ray.near_x), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[0], i), ray.origin_x), ray.far_x), far);
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[1], i), ray.origin_y), ray.near_y), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[1], i), ray.origin_y), ray.far_y), far);
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[2], i), ray.origin_z), ray.near_z), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[2], i), ray.origin_z), ray.far_z), far);
    hn::Store(near, d, entry + i);
    const auto hit = hn::Le(near, far);
    if (nearest != nullptr) {
      const auto before = hn::Load(d, nearest + i);
      hn::Store(hn::IfThenElse(hn::And(hit, hn::Lt(near, before)), near, before), d, nearest + i);
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hit, bits);
    mask |= std::uint32_t{bits[0]} << i;
  }
  return mask;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

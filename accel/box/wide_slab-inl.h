// The slab test with a slack. Per-target include guard: Highway compiles this once a SIMD target.
#if defined(CAROUSEL_ACCEL_WIDE_SLAB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_WIDE_SLAB_INL_H_
#undef CAROUSEL_ACCEL_WIDE_SLAB_INL_H_
#else
#define CAROUSEL_ACCEL_WIDE_SLAB_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/box/slab-inl.h"
#include "accel/box/wide_slab.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// A WideSlabRay in registers.
struct WideSlabLanes {
  SlabLanes slab;
  SlabLanes::Vec near_origin[3], far_origin[3];

  HWY_INLINE explicit WideSlabLanes(const WideSlabRay& ray) : slab(ray.slab) {
    const SlabLanes::Tag d;
    for (int axis = 0; axis < 3; ++axis) {
      near_origin[axis] = hn::Set(d, ray.near_origin[axis]);
      far_origin[axis] = hn::Set(d, ray.far_origin[axis]);
    }
  }
};

HWY_INLINE WideSlabLanes in_registers(const WideSlabRay& ray) {
  return WideSlabLanes(ray);
}

/// As slab_node() of a SlabLanes.
HWY_INLINE std::uint32_t slab_node(const Node& node, const WideSlabLanes& ray, float tmax, float* HWY_RESTRICT entry) {
  const SlabLanes::Tag d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const char* const planes = reinterpret_cast<const char*>(&node.plane[0][0]);
  const SlabLanes& slab = ray.slab;
  const auto plane = [&](std::uint32_t row, std::size_t i)
                         HWY_ATTR { return hn::Load(d, reinterpret_cast<const float*>(planes + row) + i); };
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kMaxWidth; i += kLanes) {
    auto near = slab.tmin;
    auto far = hn::Set(d, tmax);
    near = keep_max(hn::Mul(hn::Sub(plane(slab.near_row[0], i), ray.near_origin[0]), slab.near_x), near);
    far = keep_min(hn::Mul(hn::Sub(plane(slab.far_row[0], i), ray.far_origin[0]), slab.far_x), far);
    near = keep_max(hn::Mul(hn::Sub(plane(slab.near_row[1], i), ray.near_origin[1]), slab.near_y), near);
    far = keep_min(hn::Mul(hn::Sub(plane(slab.far_row[1], i), ray.far_origin[1]), slab.far_y), far);
    near = keep_max(hn::Mul(hn::Sub(plane(slab.near_row[2], i), ray.near_origin[2]), slab.near_z), near);
    far = keep_min(hn::Mul(hn::Sub(plane(slab.far_row[2], i), ray.far_origin[2]), slab.far_z), far);
    hn::Store(near, d, entry + i);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(near, far), bits);
    mask |= std::uint32_t{bits[0]} << i;
  }
  return mask;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// The slab test in double over the float planes of a node; otherwise as accel/box/slab-inl.h.
#if defined(CAROUSEL_ACCEL_DOUBLE_SLAB_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_DOUBLE_SLAB_INL_H_
#undef CAROUSEL_ACCEL_DOUBLE_SLAB_INL_H_
#else
#define CAROUSEL_ACCEL_DOUBLE_SLAB_INL_H_
#endif

#include <bit>

#include <hwy/highway.h>

#include "accel/box/double_slab.h"
#include "accel/box/slab-inl.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// A DoubleSlabRay in registers: one for a whole traversal.
struct DoubleSlabLanes {
  using Tag = hn::CappedTag<double, kMaxWidth>;
  using Vec = hn::Vec<Tag>;
  Vec origin_x, origin_y, origin_z, near_x, near_y, near_z, far_x, far_y, far_z, tmin;
  std::uint32_t near_row[3], far_row[3];

  HWY_INLINE explicit DoubleSlabLanes(const DoubleSlabRay& ray) {
    const Tag d;
    origin_x = hn::Set(d, ray.origin[0]), origin_y = hn::Set(d, ray.origin[1]), origin_z = hn::Set(d, ray.origin[2]);
    near_x = hn::Set(d, ray.inverse_near[0]), near_y = hn::Set(d, ray.inverse_near[1]);
    near_z = hn::Set(d, ray.inverse_near[2]), far_x = hn::Set(d, ray.inverse_far[0]);
    far_y = hn::Set(d, ray.inverse_far[1]), far_z = hn::Set(d, ray.inverse_far[2]);
    tmin = hn::Set(d, double{ray.tmin});
    for (int axis = 0; axis < 3; ++axis) {
      near_row[axis] = ray.near_row[axis];
      far_row[axis] = ray.far_row[axis];
    }
  }
};
HWY_INLINE DoubleSlabLanes in_registers(const DoubleSlabRay& ray) {
  return DoubleSlabLanes(ray);
}

/// As slab_node() for a SlabLanes, but the entries of lanes that are not hit are left alone.
HWY_INLINE std::uint32_t slab_node(const Node& node, const DoubleSlabLanes& ray, float tmax, float* HWY_RESTRICT entry,
                                   float* HWY_RESTRICT nearest = nullptr) {
  const DoubleSlabLanes::Tag d;
  const hn::Rebind<float, DoubleSlabLanes::Tag> df;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const char* const planes = reinterpret_cast<const char*>(&node.plane[0][0]);
  const auto plane = [&](std::uint32_t row, std::size_t i) HWY_ATTR {
    return hn::PromoteTo(d, hn::Load(df, reinterpret_cast<const float*>(planes + row) + i));
  };
  alignas(64) double entered[kMaxWidth];
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kMaxWidth; i += kLanes) {
    auto near = ray.tmin;
    auto far = hn::Set(d, double{tmax});
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[0], i), ray.origin_x), ray.near_x), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[0], i), ray.origin_x), ray.far_x), far);
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[1], i), ray.origin_y), ray.near_y), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[1], i), ray.origin_y), ray.far_y), far);
    near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[2], i), ray.origin_z), ray.near_z), near);
    far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[2], i), ray.origin_z), ray.far_z), far);
    hn::Store(near, d, entered + i);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(near, far), bits);
    mask |= std::uint32_t{bits[0]} << i;
  }
  for (std::uint32_t hit = mask; hit != 0; hit &= hit - 1) {
    const int lane = std::countr_zero(hit);
    entry[lane] = round_up(entered[lane]);
    if (nearest != nullptr && entry[lane] < nearest[lane]) nearest[lane] = entry[lane];
  }
  return mask;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

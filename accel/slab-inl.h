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

#include "accel/node.h"
#include "accel/slab.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// a > b ? a : b and a < b ? a : b. On x86 that is what the instruction behind Max and Min does, b being kept
// when the comparison is false or unordered; elsewhere it is spelled out.
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

/// One ray against the eight boxes of a node: bit l of the result when lane l is entered before tmax; all
/// eight entries (never below tmin) are stored.
HWY_INLINE std::uint32_t slab_node(const Node& node, const SlabRay& ray, float tmax, float* HWY_RESTRICT entry) {
  const hn::CappedTag<float, kMaxWidth> d;
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < kMaxWidth; i += kLanes) {
    auto near = hn::Set(d, ray.tmin);
    auto far = hn::Set(d, tmax);
    for (int axis = 0; axis < 3; ++axis) {
      const auto origin = hn::Set(d, ray.origin[axis]);
      const auto n = hn::Mul(hn::Sub(hn::Load(d, node.plane[ray.near_row[axis]] + i), origin),
                             hn::Set(d, ray.inverse_near[axis]));
      const auto f = hn::Mul(hn::Sub(hn::Load(d, node.plane[ray.far_row[axis]] + i), origin),
                             hn::Set(d, ray.inverse_far[axis]));
      near = keep_max(n, near);
      far = keep_min(f, far);
    }
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

// The boxes of a block's triangles, each by itself, which a hit has to pass (docs/how-it-works/accuracy.md).
#if defined(CAROUSEL_ACCEL_OWN_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_OWN_BOXES_INL_H_
#undef CAROUSEL_ACCEL_OWN_BOXES_INL_H_
#else
#define CAROUSEL_ACCEL_OWN_BOXES_INL_H_
#endif

#include <array>
#include <cstddef>
#include <limits>

#include <hwy/highway.h>

#include "accel/box/double_slab.h"
#include "accel/box/slab-inl.h"
#include "accel/structure/node.h"
#include "core/types/aabb.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE std::array<Vec3, 3> corners(const TriangleBlock& block, std::size_t lane) {
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = {block.vertex[k][0][lane], block.vertex[k][1][lane], block.vertex[k][2][lane]};
  return p;
}

HWY_INLINE Aabb box_of(const std::array<Vec3, 3>& p) {
  Aabb box;
  for (const Vec3& corner : p) box.extend(corner);
  return box;
}

/// The slab test of all boxes of a block, operation for operation what slab() does with one.
template <class Slab>
class OwnBoxes {
 public:
  HWY_INLINE OwnBoxes(const SlabRay& ray, const TriangleBlock& block) {
    const hn::CappedTag<float, kBlockTriangles> d;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::MaxLanes(d)) compute(d, ray, block, i);
  }
  /// Returns whether the box of triangle `lane` is hit before tmax; `entry` is the entry distance, not below tmin.
  HWY_INLINE bool enters(std::size_t lane, float tmax, float& entry) const {
    entry = near_[lane];
    return entry <= far_[lane] && entry <= tmax;
  }

 private:
  template <class D>
  HWY_INLINE void compute(D d, const SlabRay& ray, const TriangleBlock& block, std::size_t i) {
    auto near = hn::Set(d, ray.tmin), far = hn::Set(d, std::numeric_limits<float>::infinity());
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = hn::Load(d, block.vertex[0][axis] + i), b = hn::Load(d, block.vertex[1][axis] + i),
                 c = hn::Load(d, block.vertex[2][axis] + i);
      const auto least = keep_min(c, keep_min(b, a)), most = keep_max(c, keep_max(b, a));
      const bool forwards = ray.near_row[axis] < 3 * SlabRay::kRowBytes;
      const auto origin = hn::Set(d, ray.origin[axis]);
      near = keep_max(hn::Mul(hn::Sub(forwards ? least : most, origin), hn::Set(d, ray.inverse_near[axis])), near);
      far = keep_min(hn::Mul(hn::Sub(forwards ? most : least, origin), hn::Set(d, ray.inverse_far[axis])), far);
    }
    hn::Store(near, d, near_ + i);
    hn::Store(far, d, far_ + i);
  }

  alignas(sizeof(float) * kBlockTriangles) float near_[kBlockTriangles], far_[kBlockTriangles];
};

/// In double, which few configurations want, one by one.
template <>
class OwnBoxes<DoubleSlabRay> {
 public:
  HWY_INLINE OwnBoxes(const DoubleSlabRay& ray, const TriangleBlock& block) : ray_(ray), block_(block) {}
  HWY_INLINE bool enters(std::size_t lane, float tmax, float& entry) const {
    return slab(ray_, box_of(corners(block_, lane)), tmax, entry);
  }

 private:
  const DoubleSlabRay& ray_;
  const TriangleBlock& block_;
};

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

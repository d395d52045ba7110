// Where a ray's line meets the planes of a block of triangles, in double.
#if defined(CAROUSEL_ACCEL_PRECISE_CROSSING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_PRECISE_CROSSING_INL_H_
#undef CAROUSEL_ACCEL_PRECISE_CROSSING_INL_H_
#else
#define CAROUSEL_ACCEL_PRECISE_CROSSING_INL_H_
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "accel/box/slab-inl.h"
#include "accel/primitive/watertight.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The answers for triangles that the watertight test in float has found to be met: it decides in float, and only their
/// distances and weights are computed here, by the same steps in double. So a surface stays closed as the float decides
/// it, and t is as exact as a float can be. t lies between the distances of the corners, and the weights within the
/// triangle, also if the line passes it by as little as the float cannot tell. docs/how-it-works/accuracy.md derives
/// the bound of the error. Nothing overflows or underflows, whatever the floats.
///
/// All triangles of a block are computed at once, as one takes as long.
class PreciseCrossings {
 public:
  HWY_INLINE PreciseCrossings(const WatertightRay<float>& ray, const TriangleBlock& block) {
    const double dz = ray.direction[2], sx = ray.direction[0] / dz, sy = ray.direction[1] / dz, sz = 1.0 / dz;
    const hn::CappedTag<double, kBlockTriangles> d;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::MaxLanes(d)) compute(d, ray, block, i, sx, sy, sz);
  }

  /// False if the triangle is seen so exactly edge-on that double cannot tell its area from none: the answer in float
  /// has to do.
  HWY_INLINE bool get(std::size_t lane, Hit& hit) const {
    if (det_[lane] == 0.0) return false;
    const double first = first_[lane];
    double second = second_[lane], third = third_[lane];
    if (HWY_UNLIKELY(first < 0.0 || second < 0.0 || third < 0.0)) {
      second = std::max(second, 0.0);
      third = std::max(third, 0.0);
      const double sum = std::max(first, 0.0) + (second + third);  // 1 or more
      second /= sum;
      third /= sum;
    }
    hit.t = static_cast<float>(t_[lane]);
    hit.u = static_cast<float>(second);
    hit.v = static_cast<float>(third);
    return true;
  }

 private:
  template <class D>
  HWY_INLINE void compute(D d, const WatertightRay<float>& ray, const TriangleBlock& block, std::size_t i, double sx,
                          double sy, double sz) {
    const auto load = [&](int vertex, int axis) HWY_ATTR {
      const auto position = hn::PromoteTo(d, hn::Load(hn::Rebind<float, D>(), block.vertex[vertex][axis] + i));
      return hn::Sub(position, hn::Set(d, double{ray.origin[axis]}));
    };
    const auto shear_x = hn::Set(d, sx), shear_y = hn::Set(d, sy), shear_z = hn::Set(d, sz);
    const auto az = load(0, ray.kz), bz = load(1, ray.kz), cz = load(2, ray.kz);
    const auto ax = hn::Sub(load(0, ray.kx), hn::Mul(shear_x, az)), ay = hn::Sub(load(0, ray.ky), hn::Mul(shear_y, az));
    const auto bx = hn::Sub(load(1, ray.kx), hn::Mul(shear_x, bz)), by = hn::Sub(load(1, ray.ky), hn::Mul(shear_y, bz));
    const auto cx = hn::Sub(load(2, ray.kx), hn::Mul(shear_x, cz)), cy = hn::Sub(load(2, ray.ky), hn::Mul(shear_y, cz));
    const auto at = hn::Mul(shear_z, az), bt = hn::Mul(shear_z, bz), ct = hn::Mul(shear_z, cz);
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto det = hn::Add(u, hn::Add(v, w));
    const auto inverse = hn::Div(hn::Set(d, 1.0), det);
    const auto sum = hn::Add(hn::Mul(u, at), hn::Add(hn::Mul(v, bt), hn::Mul(w, ct)));
    const auto least = keep_min(keep_min(ct, bt), at), most = keep_max(keep_max(ct, bt), at);
    hn::Store(keep_max(least, keep_min(most, hn::Mul(sum, inverse))), d, t_ + i);
    hn::Store(hn::Mul(u, inverse), d, first_ + i);
    hn::Store(hn::Mul(v, inverse), d, second_ + i);
    hn::Store(hn::Mul(w, inverse), d, third_ + i);
    hn::Store(det, d, det_ + i);
  }

  alignas(sizeof(double) * kBlockTriangles) double t_[kBlockTriangles], first_[kBlockTriangles],
      second_[kBlockTriangles], third_[kBlockTriangles], det_[kBlockTriangles];
};

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection": one ray against a block of triangles.
// Products are never contracted: an edge shared by two triangles must give both the same number with opposite
// signs.
#if defined(CAROUSEL_ACCEL_WATERTIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_WATERTIGHT_INL_H_
#undef CAROUSEL_ACCEL_WATERTIGHT_INL_H_
#else
#define CAROUSEL_ACCEL_WATERTIGHT_INL_H_
#endif

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include <hwy/highway.h>

#include "accel/primitive/watertight.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Floats as lanes of the arithmetic that is wanted.
template <class D>
HWY_INLINE hn::Vec<D> load_floats(D d, const float* p) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>)
    return hn::Load(d, p);
  else
    return hn::PromoteTo(d, hn::Load(hn::Rebind<float, D>(), p));
}

/// Between these a sum of edge values says what exact products would say. A mesh of any size has edges beyond them if
/// the products of its coordinates are: theirs are computed in double, and scaled.
inline constexpr float kLeastEdge = 0x1p-100f, kLargestEdge = 0x1p100f;
inline constexpr double kLargestProduct = std::numeric_limits<double>::max();

/// Computes the edge values of the lanes in `which` anew, from the exact products of the sheared corners. Values of
/// extreme size are scaled by a power of two, the same for all three: only their ratios count. If their signs differ,
/// so do those of the answers.
template <class D>
HWY_NOINLINE void settle_edges(D d, hn::Mask<D> which, hn::Vec<D> ax, hn::Vec<D> ay, hn::Vec<D> bx, hn::Vec<D> by,
                               hn::Vec<D> cx, hn::Vec<D> cy, hn::Vec<D>& u, hn::Vec<D>& v, hn::Vec<D>& w) {
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  alignas(16) float a[2][kLanes], b[2][kLanes], c[2][kLanes], edge[3][kLanes];
  hn::Store(ax, d, a[0]), hn::Store(ay, d, a[1]);
  hn::Store(bx, d, b[0]), hn::Store(by, d, b[1]);
  hn::Store(cx, d, c[0]), hn::Store(cy, d, c[1]);
  hn::Store(u, d, edge[0]), hn::Store(v, d, edge[1]), hn::Store(w, d, edge[2]);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, which, bits);
  for (std::size_t l = 0; l < kLanes; ++l) {
    if (!(bits[0] >> l & 1)) continue;
    double eu = double(c[0][l]) * double(b[1][l]) - double(c[1][l]) * double(b[0][l]);
    double ev = double(a[0][l]) * double(c[1][l]) - double(a[1][l]) * double(c[0][l]);
    double ew = double(b[0][l]) * double(a[1][l]) - double(b[1][l]) * double(a[0][l]);
    if (const double most = std::fmax(std::fabs(eu), std::fmax(std::fabs(ev), std::fabs(ew)));
        (most > 0 && most < double{kLeastEdge}) || (most > double{kLargestEdge} && most <= kLargestProduct)) {
      const double scale = std::ldexp(1.0, -std::ilogb(most));
      eu *= scale, ev *= scale, ew *= scale;
    }
    // A float may lose the sign again: a triangle that is seen edge-on along a denormal direction would be hit by
    // a ray that passes it at a distance. So it is decided here, and a value of each sign says so below.
    const bool passes = (eu < 0.0 || ev < 0.0 || ew < 0.0) && (eu > 0.0 || ev > 0.0 || ew > 0.0);
    edge[0][l] = passes ? -1.0f : static_cast<float>(eu);
    edge[1][l] = passes ? 1.0f : static_cast<float>(ev);
    edge[2][l] = static_cast<float>(ew);
  }
  u = hn::Load(d, edge[0]), v = hn::Load(d, edge[1]), w = hn::Load(d, edge[2]);
}

/// The lanes whose edge values, with their sum, say that the line passes the triangle or runs in its plane.
template <class V>
HWY_INLINE auto is_outside(V u, V v, V w, V det) {
  const auto zero = hn::Zero(hn::DFromV<V>());
  const auto any_negative = hn::Or(hn::Lt(u, zero), hn::Or(hn::Lt(v, zero), hn::Lt(w, zero)));
  const auto any_positive = hn::Or(hn::Gt(u, zero), hn::Or(hn::Gt(v, zero), hn::Gt(w, zero)));
  return hn::Or(hn::And(any_negative, any_positive), hn::Eq(det, zero));
}

/// For the lanes from `i` on: bit l of the result when triangle i + l is crossed by the ray's line (whatever the
/// distance); stores t and the weights of the second and third vertex. T is float or double.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE std::uint32_t watertight_lanes(D d, const TriangleBlock& block, std::size_t i, const WatertightRay<T>& ray,
                                          T* HWY_RESTRICT t, T* HWY_RESTRICT second, T* HWY_RESTRICT third) {
  constexpr std::size_t kLanes = hn::MaxLanes(d);
  const auto load = [&](int vertex, int axis) HWY_ATTR {
    return hn::Sub(load_floats(d, block.vertex[vertex][axis] + i), hn::Set(d, ray.origin[axis]));
  };
  const auto sx = hn::Set(d, ray.sx), sy = hn::Set(d, ray.sy), sz = hn::Set(d, ray.sz);
  const auto akz = load(0, ray.kz), bkz = load(1, ray.kz), ckz = load(2, ray.kz);
  const auto ax = hn::Sub(load(0, ray.kx), hn::Mul(sx, akz)), ay = hn::Sub(load(0, ray.ky), hn::Mul(sy, akz));
  const auto bx = hn::Sub(load(1, ray.kx), hn::Mul(sx, bkz)), by = hn::Sub(load(1, ray.ky), hn::Mul(sy, bkz));
  const auto cx = hn::Sub(load(2, ray.kx), hn::Mul(sx, ckz)), cy = hn::Sub(load(2, ray.ky), hn::Mul(sy, ckz));

  auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
  auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
  auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));

  const auto zero = hn::Zero(d);
  // A zero may be a rounded one. Doubles hold the products of floats exactly, so their sign is the true one; in
  // double a rounded zero is let count as an edge for both its triangles: no leak either.
  if constexpr (std::is_same_v<T, float>) {
    const auto on_edge = hn::Or(hn::Eq(u, zero), hn::Or(hn::Eq(v, zero), hn::Eq(w, zero)));
    if (HWY_UNLIKELY(!hn::AllFalse(d, on_edge))) settle_edges(d, on_edge, ax, ay, bx, by, cx, cy, u, v, w);
  }
  auto det = hn::Add(u, hn::Add(v, w));
  auto outside = is_outside(u, v, w, det);
  if (hn::AllTrue(d, outside)) return 0;
  if constexpr (std::is_same_v<T, float>) {
    // If products overflow or underflow, neither their sum nor their quotient can be trusted. Unused lanes are not
    // looked at.
    const auto size = hn::Abs(det);
    const auto usual = hn::And(hn::Ge(size, hn::Set(d, kLeastEdge)), hn::Le(size, hn::Set(d, kLargestEdge)));
    const auto extreme = hn::AndNot(hn::Or(outside, usual), hn::Eq(akz, akz));
    if (HWY_UNLIKELY(!hn::AllFalse(d, extreme))) {
      settle_edges(d, extreme, ax, ay, bx, by, cx, cy, u, v, w);
      det = hn::Add(u, hn::Add(v, w));
      outside = is_outside(u, v, w, det);
    }
    outside = hn::Or(outside, hn::Not(hn::Eq(det, det)));  // NaN: unused lanes, and rays or corners beyond all floats
  }

  const auto scaled_t =
      hn::Add(hn::Mul(u, hn::Mul(sz, akz)), hn::Add(hn::Mul(v, hn::Mul(sz, bkz)), hn::Mul(w, hn::Mul(sz, ckz))));
  const auto inverse_det = hn::Div(hn::Set(d, T{1}), det);
  hn::Store(hn::Mul(scaled_t, inverse_det), d, t);
  hn::Store(hn::Mul(v, inverse_det), d, second);
  hn::Store(hn::Mul(w, inverse_det), d, third);
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, outside, bits);
  return ~std::uint32_t{bits[0]} & ((1u << kLanes) - 1);
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// Möller, Trumbore 1997, "Fast, minimum storage ray/triangle intersection", in float: accuracy.triangle: fast. Each
// triangle rounds the edge it shares with a neighbour in its own way, so rays slip through between the two.
#if defined(CAROUSEL_ACCEL_MOLLER_TRUMBORE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_MOLLER_TRUMBORE_INL_H_
#undef CAROUSEL_ACCEL_MOLLER_TRUMBORE_INL_H_
#else
#define CAROUSEL_ACCEL_MOLLER_TRUMBORE_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/structure/node.h"
#include "core/types/ray.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class V>
struct Lanes3 {
  V x, y, z;
};
template <class V>
HWY_INLINE Lanes3<V> cross(const Lanes3<V>& a, const Lanes3<V>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class V>
HWY_INLINE V dot(const Lanes3<V>& a, const Lanes3<V>& b) {
  return hn::Add(hn::Mul(a.x, b.x), hn::Add(hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)));
}

/// For the lanes from `i` on, what watertight_lanes() answers.
template <class D>
HWY_INLINE std::uint32_t moller_trumbore_lanes(D d, const TriangleBlock& block, std::size_t i, const Ray& ray,
                                               float* HWY_RESTRICT t, float* HWY_RESTRICT second,
                                               float* HWY_RESTRICT third) {
  using V = hn::Vec<D>;
  const auto set = [&](const Vec3& p) HWY_ATTR { return Lanes3<V>{hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)}; };
  const auto load = [&](int vertex) HWY_ATTR {
    const auto& p = block.vertex[vertex];
    return Lanes3<V>{hn::Load(d, p[0] + i), hn::Load(d, p[1] + i), hn::Load(d, p[2] + i)};
  };
  const auto sub = [](const Lanes3<V>& a, const Lanes3<V>& b) HWY_ATTR {
    return Lanes3<V>{hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
  };
  const Lanes3<V> corner = load(0), e1 = sub(load(1), corner), e2 = sub(load(2), corner);
  const Lanes3<V> direction = set(ray.direction), p = cross(direction, e2);
  const V det = dot(e1, p), inverse = hn::Div(hn::Set(d, 1.0f), det);
  const Lanes3<V> s = sub(set(ray.origin), corner), q = cross(s, e1);
  const V u = hn::Mul(dot(s, p), inverse), v = hn::Mul(dot(direction, q), inverse);
  hn::Store(hn::Mul(dot(e2, q), inverse), d, t);
  hn::Store(u, d, second);
  hn::Store(v, d, third);
  // Comparisons that NaN fails: a determinant of zero, unused lanes.
  const V zero = hn::Zero(d);
  const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)));
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(d, inside, bits);
  return bits[0];
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

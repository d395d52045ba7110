#pragma once

#include <cmath>
#include <limits>

#include "core/config/fields/accuracy.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The box test of the definition of a hit (docs/how-it-works/design.md, What a hit is), once more: written from
/// docs/how-it-works/accuracy.md for one box at a time, for the oracle alone. The kernels' own is accel/box/slab.h.
class OracleBoxTest {
 public:
  OracleBoxTest(const Ray& ray, BoxLevel level) : tmin_(ray.tmin), in_double_(level == BoxLevel::kDouble) {
    const float widening = level == BoxLevel::kPlain ? 1.0f : 1.0f + 0x1p-20f;
    prepare(single_, ray, widening);
    prepare(double_, ray, widening);
  }

  /// True if the ray meets the box between its start and `tmax`; `entry` is then its distance, rounded up to a float.
  /// A box around this one is met as well, and entered no later: every operation is monotone in the planes.
  bool enters(const Aabb& box, float tmax, float& entry) const {
    return in_double_ ? enters(double_, box, tmax, entry) : enters(single_, box, tmax, entry);
  }

 private:
  template <class Real>
  struct Axis {
    Real origin, per_near, per_far;  // distances are differences of planes and origin times these
    bool backwards;
  };
  template <class Real>
  using Axes = Axis<Real>[3];

  template <class Real>
  static void prepare(Axes<Real>& axes, const Ray& ray, float widening) {
    constexpr float kMost = std::numeric_limits<float>::max();
    for (int a = 0; a < 3; ++a) {
      const Real reciprocal = Real{1} / Real{ray.direction[a]};
      axes[a] = {Real{ray.origin[a]}, reciprocal, reciprocal * Real{widening}, std::signbit(ray.direction[a])};
      // The reciprocal of a denormal overflows. A near plane may then be entered too early, and a far one is never
      // left.
      if (ray.direction[a] != 0 && std::isinf(reciprocal)) axes[a].per_near = std::copysign(kMost, ray.direction[a]);
    }
  }

  template <class Real>
  bool enters(const Axes<Real>& axes, const Aabb& box, float tmax, float& entry) const {
    Real in = tmin_, out = tmax;
    for (int a = 0; a < 3; ++a) {
      const Axis<Real>& axis = axes[a];
      const Real first = axis.backwards ? box.hi[a] : box.lo[a], last = axis.backwards ? box.lo[a] : box.hi[a];
      const Real near = (first - axis.origin) * axis.per_near, far = (last - axis.origin) * axis.per_far;
      if (near > in) in = near;  // NaN, from a plane that the ray runs in, decides nothing
      if (far < out) out = far;
    }
    entry = static_cast<float>(in);
    if (entry < in) entry = std::nextafter(entry, kInfinity);
    return in <= out;
  }

  Axes<float> single_;
  Axes<double> double_;
  float tmin_;
  bool in_double_;
};

}  // namespace carousel::accel

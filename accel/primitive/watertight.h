#pragma once

#include <cmath>

#include "core/types/ray.h"

namespace carousel::accel {

/// Per-ray constants of the watertight test: the axis the ray mostly runs along is z, and shearing makes the
/// ray's direction (0, 0, 1) (Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection", section 3).
/// T is the arithmetic: float for accuracy.triangle: watertight, double for double.
template <class T>
struct WatertightRay {
  T origin[3];
  int kx, ky, kz;
  float direction[3];  ///< along kx, ky and kz
  T sx, sy, sz;

  [[gnu::always_inline]] explicit WatertightRay(const Ray& ray) : origin{ray.origin.x, ray.origin.y, ray.origin.z} {
    const Vec3& d = ray.direction;
    // Selections and a table instead of branches, which bounce rays would mispredict.
    const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
    const int larger = ay >= ax ? 1 : 0;
    kz = az >= (larger ? ay : ax) ? 2 : larger;
    static constexpr int kAfter[2][3][2] = {{{1, 2}, {2, 0}, {0, 1}}, {{2, 1}, {0, 2}, {1, 0}}};
    const int* const after = kAfter[d[kz] < 0.0f][kz];  // swapped when the ray runs backwards: keeps the winding
    kx = after[0];
    ky = after[1];
    direction[0] = d[kx], direction[1] = d[ky], direction[2] = d[kz];
    // One division for all three.
    typedef T T4 __attribute__((vector_size(4 * sizeof(T))));
    const T4 shear = T4{T{direction[0]}, T{direction[1]}, T{1}, T{1}} / T{direction[2]};
    sx = shear[0];
    sy = shear[1];
    sz = shear[2];
  }
};

}  // namespace carousel::accel

#pragma once

#include <cmath>

#include "core/ray.h"

namespace carousel::accel {

/// Per-ray constants of the watertight test: the axis the ray mostly runs along is z, and shearing makes the
/// ray's direction (0, 0, 1) (Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection", section 3).
struct WatertightRay {
  float origin[3];
  int kx, ky, kz;
  float sx, sy, sz;

  [[gnu::always_inline]] explicit WatertightRay(const Ray& ray) : origin{ray.origin.x, ray.origin.y, ray.origin.z} {
    const Vec3& d = ray.direction;
    const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
    kz = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    if (d[kz] < 0.0f) {   // keeps the winding
      const int swap = kx;
      kx = ky;
      ky = swap;
    }
    // One division for all three.
    using Float4 = float __attribute__((vector_size(16)));
    const Float4 shear = Float4{d[kx], d[ky], 1.0f, 1.0f} / d[kz];
    sx = shear[0];
    sy = shear[1];
    sz = shear[2];
  }
};

}  // namespace carousel::accel

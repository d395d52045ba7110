#pragma once

#include <bit>
#include <cstdint>
#include <limits>

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
    // Arithmetic and a table instead of branches, which bounce rays would mispredict: absolute values are in the order
    // of their bits, and compilers make branches of comparisons.
    const auto size = [](float x) { return std::bit_cast<std::int32_t>(x) & std::numeric_limits<std::int32_t>::max(); };
    const auto is_most = [](std::int32_t a, std::int32_t b) { return std::bit_cast<std::uint32_t>(b - a - 1) >> 31; };
    const std::int32_t x = size(d.x), y = size(d.y), z = size(d.z);
    const auto along_y = static_cast<std::int32_t>(is_most(y, x));
    const auto along_z = static_cast<std::int32_t>(is_most(z, x + ((y - x) & -along_y)));
    kz = along_z << 1 | (along_y & ~along_z);
    static constexpr int kAfter[2][3][2] = {{{1, 2}, {2, 0}, {0, 1}}, {{2, 1}, {0, 2}, {1, 0}}};
    const int* const after = kAfter[std::bit_cast<std::uint32_t>(d[kz]) >> 31]
                                   [kz];  // swapped when the ray runs backwards: keeps the winding
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

#pragma once

#include <array>
#include <cstdint>

#include "core/numeric/exponential.h"

namespace carousel::shading {

/// Linear values of the 256 sRGB codes (IEC 61966-2-1).
inline const std::array<float, 256>& srgb_to_linear() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> t{};
    for (int i = 0; i < 256; ++i) {
      const double c = i / 255.0;
      t[static_cast<std::size_t>(i)] =
          static_cast<float>(c <= 0.04045 ? c / 12.92 : pow_precise((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table;
}

/// The inverse on [0, 1], for display.
inline float linear_to_srgb(float c) {
  return c <= 0.0031308f ? 12.92f * c : 1.055f * pow_float(c, 1.0f / 2.4f) - 0.055f;
}

}  // namespace carousel::shading

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>

#include <fmt/format.h>

#include "core/types/vec.h"

namespace carousel {

/// Four bytes of a Radiance pixel, rounded; exact for a power of two.
inline std::string rgbe(const Vec3& color) {
  const float most = std::max({color.x, color.y, color.z});
  if (!(most > 0)) return std::string(4, '\0');
  int exponent = 0;
  std::frexp(most, &exponent);
  if (std::lround(std::ldexp(most, 8 - exponent)) == 256) ++exponent;
  std::string out;
  for (int c = 0; c < 3; ++c) out += static_cast<char>(std::lround(std::ldexp(color[c], 8 - exponent)));
  return out + static_cast<char>(exponent + 128);
}

inline std::string hdr_header(int width, int height, const std::string& variables = "FORMAT=32-bit_rle_rgbe\n") {
  return fmt::format("#?RADIANCE\n{}\n-Y {} +X {}\n", variables, height, width);
}

/// A Radiance picture of flat pixels; `color(x, y)` from the top left.
inline std::string hdr_file(int width, int height, const std::function<Vec3(int, int)>& color) {
  std::string out = hdr_header(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out += rgbe(color(x, y));
  return out;
}

}  // namespace carousel

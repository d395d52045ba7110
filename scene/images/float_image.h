#pragma once

#include <cstdint>
#include <vector>

#include "core/types/vec.h"

namespace carousel::scene {

/// Decoded pixels of any brightness, as they stand in the file: row-major from the top left, linear RGB.
struct FloatImage {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3> pixels;
};

/// Bytes of a pixel of a FloatImage.
inline constexpr std::uint64_t kFloatPixelBytes = sizeof(Vec3);
/// Most pixels along a side that the decoders read.
inline constexpr std::uint32_t kMostSide = 65536;

}  // namespace carousel::scene

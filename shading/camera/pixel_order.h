#pragma once

#include <cstdint>

namespace carousel::shading {

/// One path of the frame.
struct PixelSample {
  std::uint32_t x = 0, y = 0, sample = 0;
};

/// The order in which the frame's paths start: tile by tile of 8 x 8 pixels, in a tile sample by sample, and
/// along a Z curve, so that paths that start together go to the same places.
class PixelOrder {
 public:
  /// All at least 1; their product fits 63 bits.
  PixelOrder(std::uint32_t width, std::uint32_t height, std::uint32_t samples)
      : width_(width), height_(height), samples_(samples) {}

  std::uint64_t count() const { return std::uint64_t{width_} * height_ * samples_; }
  /// Precondition: ordinal < count(). A bijection.
  PixelSample at(std::uint64_t ordinal) const;

 private:
  std::uint32_t width_, height_, samples_;
};

}  // namespace carousel::shading

#pragma once

#include <algorithm>
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

  static constexpr std::uint32_t kTile = 8;  ///< pixels, either way

  std::uint32_t samples() const { return samples_; }
  std::uint32_t tile_columns() const { return (width_ + kTile - 1) / kTile; }
  std::uint32_t tile_rows() const { return (height_ + kTile - 1) / kTile; }
  /// The tile's first path. Its paths follow one another: first sample 0 of all its pixels.
  std::uint64_t tile_begin(std::uint64_t column, std::uint64_t row) const {
    return kTile * std::uint64_t{samples_} * (row * width_ + column * tile_height(row));
  }
  std::uint64_t tile_pixels(std::uint64_t column, std::uint64_t row) const {
    return std::min<std::uint64_t>(kTile, width_ - column * kTile) * tile_height(row);
  }

  /// The number of a pixel's tile, row by row.
  std::uint64_t tile_of(std::uint32_t x, std::uint32_t y) const {
    return std::uint64_t{y / kTile} * tile_columns() + x / kTile;
  }

  std::uint64_t count() const { return std::uint64_t{width_} * height_ * samples_; }
  /// Precondition: ordinal < count(). A bijection.
  PixelSample at(std::uint64_t ordinal) const;

 private:
  std::uint64_t tile_height(std::uint64_t row) const { return std::min<std::uint64_t>(kTile, height_ - row * kTile); }

  std::uint32_t width_, height_, samples_;
};

}  // namespace carousel::shading

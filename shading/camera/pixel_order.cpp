#include "shading/camera/pixel_order.h"

#include <algorithm>

namespace carousel::shading {

namespace {

/// Packs every second of 6 bits.
std::uint32_t even_bits(std::uint32_t z) {
  return (z & 1) | (z >> 1 & 2) | (z >> 2 & 4);
}

}  // namespace

PixelSample PixelOrder::at(std::uint64_t ordinal) const {
  const std::uint64_t tile_row_paths = std::uint64_t{kTile} * width_ * samples_;
  const auto tile_y = static_cast<std::uint32_t>(ordinal / tile_row_paths);
  ordinal %= tile_row_paths;
  // Rows of tiles at the lower edge, and tiles at the right, may be cut.
  const std::uint32_t h = std::min(kTile, height_ - tile_y * kTile);
  const std::uint64_t tile_paths = std::uint64_t{kTile} * h * samples_;
  const auto tile_x = static_cast<std::uint32_t>(ordinal / tile_paths);
  ordinal %= tile_paths;
  const std::uint32_t w = std::min(kTile, width_ - tile_x * kTile);

  const auto within = static_cast<std::uint32_t>(ordinal % (w * h));
  const auto sample = static_cast<std::uint32_t>(ordinal / (w * h));
  const bool whole = w == kTile && h == kTile;
  const std::uint32_t x = whole ? even_bits(within) : within % w;
  const std::uint32_t y = whole ? even_bits(within >> 1) : within / w;
  return {tile_x * kTile + x, tile_y * kTile + y, sample};
}

}  // namespace carousel::shading

#pragma once

#include <cstdint>
#include <span>

#include "scene/model/scene.h"

namespace carousel::scene {

struct WebpHeader {
  std::uint32_t width = 0, height = 0;
};

/// Size of a still WebP picture. Throws std::runtime_error with a reason: broken, or animated.
WebpHeader read_webp_header(std::span<const unsigned char> encoded);

/// The pixels of the picture, not multiplied by alpha. Allocates memory for the header's size, which the caller has to
/// check first. Throws std::runtime_error with a reason.
Image decode_webp(std::span<const unsigned char> encoded, const WebpHeader& header);

}  // namespace carousel::scene

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

/// Its pixels. (Not with OpenImageIO 2.4, which multiplies WebP by alpha whatever it is told, and so loses the colours
/// that filters see beside what is cut out.) Allocates for the header's size: judge that first. Throws
/// std::runtime_error with a reason.
Image decode_webp(std::span<const unsigned char> encoded, const WebpHeader& header);

}  // namespace carousel::scene

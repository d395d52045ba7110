#pragma once

#include <cstdint>
#include <span>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Decodes a PNG, a JPEG or a still WebP, without touching its transfer curve or
/// multiplying by alpha. Grey becomes RGB, missing alpha 255, 16 bits are rounded to 8. Throws std::runtime_error with
/// a reason: none of these formats, broken, more than 2^26 pixels, or more pixels than so few bytes can hold.
Image decode_image(std::span<const unsigned char> encoded);

}  // namespace carousel::scene

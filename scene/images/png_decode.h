#pragma once

#include <cstdint>
#include <span>

#include "scene/model/scene.h"

namespace carousel::scene {

/// The pixels of a PNG picture that png_fault() has nothing against, as the file has them: palettes and fewer bits are
/// widened, 16 bits rounded to 8, and neither the transfer curve nor alpha changes a colour. Allocates memory for the
/// header's size, which the caller has to check first. Throws std::runtime_error with a reason.
Image decode_png(std::span<const unsigned char> encoded);

}  // namespace carousel::scene

#pragma once

#include <span>

#include "core/system/memory_budget.h"
#include "scene/images/float_image.h"

namespace carousel::scene {

/// True if the bytes start as an OpenEXR picture does.
bool is_exr(std::span<const unsigned char> encoded);

/// Decodes the first picture of an OpenEXR file, with the channels R, G and B, or Y alone, of any of its types. Throws
/// std::runtime_error for what is broken or has no such channels, and std::length_error, before the pixels are
/// allocated, for more than `memory` has left.
FloatImage decode_exr(std::span<const unsigned char> encoded, MemoryBudget& memory);

}  // namespace carousel::scene

#pragma once

#include <span>

#include "core/system/memory_budget.h"
#include "scene/images/float_image.h"

namespace carousel::scene {

/// True if the bytes start as a Radiance picture does.
bool is_hdr(std::span<const unsigned char> encoded);

/// Decodes a Radiance picture of the format 32-bit_rle_rgbe whose rows go from the top left: flat pixels, the old run
/// lengths and those of scan lines, which the file may mix (G. Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's
/// reference manual, file formats). Values are those before EXPOSURE was applied. Throws std::runtime_error that names
/// the byte for what is broken or of another kind, and std::length_error, before the pixels are allocated, for more
/// than `memory` has left.
FloatImage decode_hdr(std::span<const unsigned char> encoded, MemoryBudget& memory);

}  // namespace carousel::scene

#pragma once

#include <cstdint>
#include <span>

#include "core/system/memory_budget.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Decodes a PNG, a JPEG or a still WebP, without touching its transfer curve or
/// multiplying by alpha. Grey becomes RGB, missing alpha 255, 16 bits are rounded to 8. Throws std::runtime_error with
/// a reason for none of these formats and for broken ones, and std::length_error, before the pixels are allocated, for
/// more than `memory` has left.
Image decode_image(std::span<const unsigned char> encoded, MemoryBudget& memory);

}  // namespace carousel::scene

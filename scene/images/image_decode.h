#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/system/memory_budget.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// What is known of a picture beside its bytes.
struct PictureHint {
  std::string name;   ///< of its file; some formats can be told by its ending alone. May be empty
  bool color = true;  ///< it is used as colours, so that linear light in it has to become sRGB
};

/// Decodes a PNG, a JPEG or a still WebP, without touching its transfer curve or
/// multiplying by alpha. Grey becomes RGB, missing alpha 255, 16 bits are rounded to 8. Other formats are decoded by
/// the module pictures (docs/how-it-works/modules.md). Throws std::runtime_error with a reason for none of these
/// formats, for broken ones and where the module is missing; std::length_error, before the pixels are allocated, for
/// more than `memory` has left; and Interrupted.
Image decode_image(std::span<const unsigned char> encoded, MemoryBudget& memory, const PictureHint& hint = {});

/// Throws the std::length_error of a picture that needs more than `memory` has left.
void throw_if_too_large(std::uint32_t width, std::uint32_t height, std::uint64_t bytes, MemoryBudget& memory);

}  // namespace carousel::scene

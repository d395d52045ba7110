#pragma once

#include <cstdint>

namespace carousel::shading {

/// One enumerator for each random decision; the random number is keyed by it (core/numeric/rng.h). Four neighbours that
/// start at a multiple of four come from one call of the generator, so numbers that are used together stand together.
enum class Dimension : std::uint32_t {
  kPixelX = 0,
  kPixelY,
  kLensX,
  kLensY,
  kLightChoice = 4,
  kLightU,
  kLightV,
  kRoulette,
  kLobe = 8,
  kDirectionU,
  kDirectionV,
};

}  // namespace carousel::shading

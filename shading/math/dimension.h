#pragma once

#include <cstdint>

namespace carousel::shading {

/// One enumerator a random decision; the number is keyed by it (core/numeric/rng.h). Four neighbours, starting at a
/// multiple of four, come from one call of the generator: what is needed together stands together.
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

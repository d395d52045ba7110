#pragma once

#include <cstdint>

#include "core/numeric/rng.h"
#include "core/types/vec.h"

namespace carousel::shading {

/// The random numbers in [0, 1) that start a path.
struct CameraDraw {
  Vec2 pixel;  ///< position within the pixel, from its top left
  Vec2 lens;
};

/// Random numbers that choose a light and a point on it.
struct LightDraw {
  std::uint32_t choice = 0;  ///< all 32 bits: there may be millions of lights
  Vec2 point;
  float roulette = 0;
};

/// Random numbers that choose the next direction.
struct DirectionDraw {
  float lobe = 0;
  Vec2 direction;
};

/// The random numbers of a frame's paths: pure functions of (seed, pixel, sample, bounce, dimension). The
/// samples of one pixel are stratified against each other up to the first surface, where it matters most; beyond it
/// they are independent, which is cheaper.
class Sampler {
 public:
  /// `samples` is the number of samples a pixel, at least 1.
  Sampler(std::uint64_t seed, std::uint32_t samples);

  CameraDraw camera(std::uint32_t pixel, std::uint32_t sample) const;
  LightDraw light(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce) const;
  DirectionDraw direction(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce) const;

 private:
  Vec2 stratified(std::uint32_t sample, std::uint32_t pattern, std::uint32_t jitter_x, std::uint32_t jitter_y) const;
  std::uint32_t stratified(std::uint32_t sample, std::uint32_t pattern, std::uint32_t jitter) const;
  std::uint32_t pattern(const RandomKey& key, std::uint32_t dimension) const;

  std::uint64_t seed_;
  std::uint32_t samples_, columns_, rows_;
};

}  // namespace carousel::shading

#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

struct ImageConfig {
  std::int64_t width = 256, height = 256;
  std::int64_t samples = 4;
  std::int64_t max_depth = 4;
  std::int64_t seed = 1;
  float exposure = 0;
};

namespace config {

template <class V>
void describe(V& v, ImageConfig& c) {
  v.field("width", c.width, IntRange{1, 16384}, "pixels", "The width of the picture.");
  v.field("height", c.height, IntRange{1, 16384}, "pixels", "The height of the picture.");
  v.field("samples", c.samples, IntRange{1, 65536}, "paths per pixel", "The number of samples of each pixel.");
  v.field("max_depth", c.max_depth, IntRange{1, 64}, "surfaces",
          "The number of surfaces that a path may visit. With 1 there is direct light only.");
  v.field("seed", c.seed, kSeed, "", "The seed of all random numbers of the picture.");
  v.field(
      "exposure", c.exposure, RealRange{-30, 30}, "stops",
      "The exposure of image.png: each stop doubles its light before the tone curve. image.exr and the digests keep "
      "the light as it was computed.");
}

}  // namespace config
}  // namespace carousel

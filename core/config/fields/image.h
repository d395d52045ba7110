#pragma once

#include <cstdint>
#include <vector>

#include "core/config/fields/field.h"

namespace carousel {

/// A format that a picture is written in, by the ending of its file. All but the first two are written by the module
/// pictures (docs/how-it-works/modules.md).
enum class PictureFile : std::uint8_t {
  kPng,
  kExr,
  kTiff,
  kHdr,
  kPfm,
  kFits,
  kJpg,
  kJp2,
  kWebp,
  kTga,
  kBmp,
  kGif,
  kPpm,
  kDpx,
  kSgi,
  kRla,
  kIff,
};

struct ImageConfig {
  std::int64_t width = 256, height = 256;
  std::int64_t samples = 4;
  std::int64_t max_depth = 4;
  std::int64_t seed = 1;
  float exposure = 0;
  std::vector<PictureFile> files{PictureFile::kPng, PictureFile::kExr};
};

template <>
inline constexpr auto kEnumNames<PictureFile> = [] {
  using enum PictureFile;
  return names<PictureFile>({{kPng, "png"},
                             {kExr, "exr"},
                             {kTiff, "tiff"},
                             {kHdr, "hdr"},
                             {kPfm, "pfm"},
                             {kFits, "fits"},
                             {kJpg, "jpg"},
                             {kJp2, "jp2"},
                             {kWebp, "webp"},
                             {kTga, "tga"},
                             {kBmp, "bmp"},
                             {kGif, "gif"},
                             {kPpm, "ppm"},
                             {kDpx, "dpx"},
                             {kSgi, "sgi"},
                             {kRla, "rla"},
                             {kIff, "iff"}});
}();

namespace config {

template <class V>
void describe(V& v, ImageConfig& c) {
  v.field("width", c.width, IntRange{1, 16384}, "pixels", "The width of the picture.");
  v.field("height", c.height, IntRange{1, 16384}, "pixels", "The height of the picture.");
  v.field("samples", c.samples, IntRange{1, 65536}, "paths per pixel", "The number of samples of each pixel.");
  v.field("max_depth", c.max_depth, IntRange{1, 64}, "surfaces",
          "The number of surfaces that a path may visit. With 1 there is direct light only.");
  v.field("seed", c.seed, kSeed, "", "The seed of all random numbers of the picture.");
  v.field("exposure", c.exposure, RealRange{-30, 30}, "stops",
          "The exposure of image.png and of other pictures for display: each stop doubles their light before the tone "
          "curve. Pictures of floats (exr, tiff, hdr, pfm, fits) and the digests keep the light as it was computed.");
  v.choices("files", c.files,
            "The pictures that a run writes: image.png, image.exr and so on. All but png and exr need the module "
            "pictures (docs/how-it-works/modules.md). The page of a run shows image.png.");
}

}  // namespace config
}  // namespace carousel

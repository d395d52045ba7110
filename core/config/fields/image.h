#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/fields/engine_kind.h"
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

/// The unit that builds or refits the structure in the simulated machine.
struct BuilderConfig {
  /// Of a primitive's record: a box and a number, at a border of 32 bytes.
  static constexpr std::int64_t kRecordBytes = 32;

  std::int64_t bytes_per_cycle = 64;
  std::int64_t boxes_per_cycle = 1;
  std::int64_t latency_cycles = 4;
  std::int64_t requests = 64;
  std::int64_t local_primitives = 1024;
  enum class Asks : std::uint8_t { kMemory, kL2 } asks = Asks::kMemory;
};
template <>
inline constexpr auto kEnumNames<BuilderConfig::Asks> = [] {
  using enum BuilderConfig::Asks;
  return names<BuilderConfig::Asks>({{kMemory, "memory"}, {kL2, "l2"}});
}();

/// The unit that rasterises first hits in the simulated machine (`primary: raster`).
struct RasterConfig {
  enum class Time : std::uint8_t { kFree, kCycles } time = Time::kFree;
  std::int64_t triangles_per_cycle = 1, tiles_per_cycle = 1, samples_per_cycle = 64;
  std::int64_t bytes_per_cycle = 64, requests = 256, latency_cycles = 16;
};
template <>
inline constexpr auto kEnumNames<RasterConfig::Time> = [] {
  using enum RasterConfig::Time;
  return names<RasterConfig::Time>({{kFree, "free"}, {kCycles, "cycles"}});
}();

/// How the structure follows a scene that moves.
enum class FrameUpdate : std::uint8_t { kRefit, kRebuild, kClusters, kNone };
template <>
inline constexpr auto kEnumNames<FrameUpdate> = [] {
  using enum FrameUpdate;
  return names<FrameUpdate>({{kRefit, "refit"}, {kRebuild, "rebuild"}, {kClusters, "clusters"}, {kNone, "none"}});
}();

/// A series of pictures of a scene that moves.
struct FramesConfig {
  std::int64_t count = 1;
  std::int64_t first = 0;
  double step = 0.04;
  FrameUpdate update = FrameUpdate::kRefit;
  std::optional<std::int64_t> cluster_primitives;  ///< absent: `auto`
  BuilderConfig builder;
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
  v.field("exposure", c.exposure, RealRange{-30, 30}, "stops",
          "The exposure of image.png and of other pictures for display: each stop doubles their light before the tone "
          "curve. Pictures of floats (exr, tiff, hdr, pfm, fits) and the digests keep the light as it was computed.");
  v.choices("files", c.files,
            "The pictures that a run writes: image.png, image.exr and so on. All but png and exr need the module "
            "pictures (docs/how-it-works/modules.md). The page of a run shows image.png.");
}

template <class V>
void describe(V& v, BuilderConfig& c) {
  v.field("bytes_per_cycle", c.bytes_per_cycle, IntRange{1, 4096}, "bytes/cycle",
          "The bytes that the builder reads and writes in a cycle.");
  v.field("boxes_per_cycle", c.boxes_per_cycle, IntRange{1, 1024}, "boxes/cycle",
          "The boxes that it adds to others, or sorts into bins, in a cycle.");
  v.field("latency_cycles", c.latency_cycles, IntRange{1, 1000}, "cycles",
          "The cycles from the last box of a task into this pipeline to its result.");
  v.field("requests", c.requests, IntRange{1, 65536}, "lines", "The lines that it can wait for at a time.");
  v.field("local_primitives", c.local_primitives, IntRange{1, 1 << 24}, "primitives",
          "A subtree of at most so many primitives is built in a store of its own, from one reading of them. With "
          "frames.update: clusters a mesh of more clusters than that has the nodes above them refitted.");
  v.choice(
      "asks", c.asks,
      "The builder reads and writes lines of the memory, or asks the first L2 for them. What the builder leaves there "
      "the rays find. Lines that stay there written (memory.l2_write: back) go to the memory before the first ray.");
}

template <class V>
void describe(V& v, RasterConfig& c) {
  v.choice("time", c.time,
           "With primary: raster, the pass takes no time and its samples are where shading needs them; or a unit reads "
           "vertices and writes the samples through the first L2, before the first ray, and shading reads them.")
      .only(EngineKind::kCycle, "simulated memory", RasterConfig::Time::kCycles);
  v.field("triangles_per_cycle", c.triangles_per_cycle, IntRange{1, 64}, "triangles/cycle",
          "The triangles whose edges are set up, to sort them into tiles and again in each tile.");
  v.field("tiles_per_cycle", c.tiles_per_cycle, IntRange{1, 64}, "tiles/cycle",
          "The tiles into whose lists triangles are sorted.");
  v.field("samples_per_cycle", c.samples_per_cycle, IntRange{1, 4096}, "tests/cycle",
          "The tests of a sample against the edges of a triangle.");
  v.field("bytes_per_cycle", c.bytes_per_cycle, IntRange{1, 4096}, "bytes/cycle",
          "The bytes that the unit reads and writes.");
  v.field("requests", c.requests, IntRange{1, 65536}, "lines", "The lines that it can wait for at a time.");
  v.field("latency_cycles", c.latency_cycles, IntRange{1, 1000}, "cycles",
          "The cycles from the last triangle or test of a task to its result.");
}

template <class V>
void describe(V& v, FramesConfig& c) {
  v.field("count", c.count, IntRange{1, 10000}, "frames",
          "The number of pictures, one after another. Shared caches stay warm from one to the next.");
  v.field("first", c.first, IntRange{0, 1'000'000}, "frames",
          "The number of the first picture. The structure is built for it before the run.");
  v.field(
      "step", c.step, RealRange{0, 1e6}, "seconds",
      "The time between pictures. Frame 0 shows the moment of scene.time or of scene.animation.time; a built-in scene "
      "without one begins at 0.");
  v.choice("update", c.update,
           "For each further picture the structure keeps its nodes and gets new boxes, or is built anew, or is renewed "
           "in those clusters whose primitives have moved, or stays as it is; then nothing but the camera may move.");
  v.field_or_auto(
      "cluster_primitives", c.cluster_primitives, IntRange{1, 1 << 20}, "primitives",
      "A cluster of a mesh is a largest subtree of at most so many primitives. With auto it is the least power "
      "of two for which the mesh has at most frames.builder.local_primitives clusters.");
  v.section("builder", c.builder, "The unit that does this in the simulated machine, before the rays of a picture.");
}

}  // namespace config
}  // namespace carousel

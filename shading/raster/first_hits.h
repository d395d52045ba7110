#pragma once

#include <cstdint>
#include <vector>

#include "core/config/config.h"
#include "core/statistics/raster_counts.h"
#include "core/system/executor.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// The first hits of the camera rays of a frame, found without tracing them.
struct FirstHits {
  using Counts = RasterCounts;
  /// Of a sample in the simulated memory: distance, weights, instance and primitive. They stand there in the order in
  /// which the paths of the frame start (PixelOrder).
  static constexpr std::uint32_t kSampleBytes = 20;

  std::uint32_t samples = 0;               ///< a pixel
  std::vector<Hit> hits;                   ///< pixel-major; a miss has no instance
  std::vector<std::uint8_t> left_to_rays;  ///< by pixel, row-major: 1 where procedural primitives may be seen
  Counts counts;

  struct Triangle {
    std::uint32_t instance, primitive;
  };
  /// The work of a tile: its triangles, in the order of instances, and its parts of `counts.tested` and
  /// `counts.any_hit_calls`.
  struct Tile {
    std::vector<Triangle> triangles;
    std::uint64_t tested = 0, asked = 0;
  };
  std::vector<Tile> tiles;  ///< row-major, with raster.time: cycles; as large as those of PixelOrder

  /// Null where a ray has to be sent.
  const Hit* at(std::uint32_t pixel, std::uint32_t sample) const {
    if (left_to_rays[pixel] != 0) return nullptr;
    return &hits[std::size_t{pixel} * samples + sample];
  }
};

/// A small rasteriser: triangles are sorted into tiles of 8 x 8 pixels, and in each tile evaluated at the very rays
/// that CameraRays would send. The ray flags of `shading.camera_rays` apply here as well. All arithmetic is in double;
/// the nearest t, rounded to float, wins, and ties go to the smallest (instance, primitive). Alpha-masked and
/// alpha-blended surfaces call `any_hit` (null: every surface is opaque). The result does not depend on `executor`.
///
/// Preconditions, which the config's rules ensure: the camera is a pinhole (aperture 0); width * height below 2^32.
/// Throws std::out_of_range if the scene has no camera `scene.camera`.
FirstHits rasterize_first_hits(const scene::Scene& scene, const Config& config, const AnyHit* any_hit,
                               Executor& executor);

}  // namespace carousel::shading

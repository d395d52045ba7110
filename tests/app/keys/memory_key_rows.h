#pragma once

#include <string>
#include <vector>

#include "tests/app/keys/key_row.h"

namespace carousel {

inline const std::vector<std::string> kSmallDataCache{"shading.program.default=built_in", "shading.workers=1",
                                                      "shading.data_cache.bytes=1024"};

inline const std::vector<std::string> kRasterUnit{"primary=raster", "raster.time=cycles"};

/// The rows of caches of shader workers, of pages, and of the rasteriser.
inline std::vector<KeyRow> memory_key_rows() {
  using enum BaseMachine;
  return {
      {"shading.data_cache.bytes", kTerrain, {"shading.program.default=built_in", "shading.workers=1"}, {"1024"}},
      {"shading.data_cache.line_bytes", kTerrain, kSmallDataCache, {"256"}},
      {"shading.data_cache.ways", kTerrain, kSmallDataCache, {"1"}},
      {"shading.data_cache.latency_cycles", kTerrain, kSmallDataCache, {"400"}},
      {"shading.translation.page_bytes", kTerrain, {"shading.program.default=built_in", "shading.workers=1"}, {"4096"}},
      {"shading.translation.entries",
       kTerrain,
       {"shading.program.default=built_in", "shading.workers=1", "shading.translation.page_bytes=4096"},
       {"1"}},
      {"memory.translation.page_bytes", kTerrain, {}, {"4096"}},
      {"memory.translation.entries", kTerrain, {"memory.translation.page_bytes=4096"}, {"1"}},
      {"raster.time", kTerrain, {"primary=raster"}},
      {"raster.triangles_per_cycle",
       kTerrain,
       {"primary=raster", "raster.time=cycles", "raster.tiles_per_cycle=64"},
       {"64"}},
      {"raster.tiles_per_cycle",
       kTerrain,
       {"primary=raster", "raster.time=cycles", "raster.triangles_per_cycle=64"},
       {"64"}},
      {"raster.samples_per_cycle", kTerrain, kRasterUnit, {"1"}},
      {"raster.bytes_per_cycle", kTerrain, kRasterUnit, {"1"}},
      {"raster.requests", kTerrain, kRasterUnit, {"1"}},
      {"raster.latency_cycles", kTerrain, kRasterUnit, {"200"}},
  };
}

}  // namespace carousel

#pragma once

#include <string>
#include <vector>

#include "tests/app/keys/key_row.h"

namespace carousel {

inline const std::vector<std::string> kSmallDataCache{"shading.program.default=built_in", "shading.workers=1",
                                                      "shading.data_cache.bytes=1024"};

/// The rows of caches of shader workers, and of pages.
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
  };
}

}  // namespace carousel

#include "ringbus/resource/settings.h"

#include "core/config/config.h"

namespace carousel::ringbus {

ResourceSettings resource_settings(const Config& config, float scene_size) {
  return {config.collections,
          config.packets,
          config.bundles,
          config.bvh.treelet_triangles,
          static_cast<std::uint32_t>(config.topology.resources),
          scene_size,
          config.bvh.treelets.bytes > 0,
          config.engine.lanes};
}

}  // namespace carousel::ringbus

#include "ringbus/resource/settings.h"

#include "core/config/config.h"

namespace carousel::ringbus {

ResourceSettings resource_settings(const Config& config, float scene_size) {
  // Lists of sorted rays stay long in large treelets, too.
  const bool sorted = config.rays.sort == RaySort::kCells;
  const Lanes lanes = sorted && config.engine.lanes == Lanes::kAuto ? Lanes::kRays : config.engine.lanes;
  return {config.collections,
          config.packets,
          config.bundles,
          config.bvh.treelet_triangles,
          static_cast<std::uint32_t>(config.topology.resources),
          scene_size,
          config.bvh.treelets.bytes > 0,
          lanes};
}

}  // namespace carousel::ringbus

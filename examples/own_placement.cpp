// A part as a plugin, the dispatch of new rays, `rays.placement: octants`: which resource stores a ray.
#include <cstdint>

#include "ringbus/plugin/bring.h"

namespace {

/// Rays of one octant of directions go to the same resources, whose packets then find rays that go the same way.
std::uint32_t octants(const carousel::RayRequest& request, const carousel::ringbus::PlacementFacts& facts) {
  const carousel::Vec3 along = request.ray.direction;
  const std::uint32_t octant = (along.x < 0 ? 1u : 0u) | (along.y < 0 ? 2u : 0u) | (along.z < 0 ? 4u : 0u);
  const auto resources = static_cast<std::uint32_t>(facts.free_slots.size());
  if (resources <= 8) return octant % resources;
  // Each octant has a run of resources, which take its rays in turn.
  const std::uint32_t first = octant * resources / 8, end = (octant + 1) * resources / 8;
  return first + static_cast<std::uint32_t>(facts.placed % (end - first));
}

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("octants", "1.0", [](carousel::PluginParts& parts) {
    carousel::ringbus::bring_placement(parts, "octants", {.choose = octants});
  });
  return &info;
}

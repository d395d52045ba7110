// A policy as a plugin, `collections.policy: broad_first`: which collection of rays a resource issues next.
#include <algorithm>
#include <cstdint>

#include "ringbus/plugin/bring.h"
#include "ringbus/resource/collections/priority_lists.h"

namespace {

namespace ringbus = carousel::ringbus;

/// Collections near the root first, and of those at one depth the ones with many rays: new rays are spread over the
/// machine before old ones are finished. The lowest bucket goes first.
std::uint32_t broad_first(const ringbus::CollectionFacts& collection, const ringbus::PolicyScale& scale) {
  const std::uint32_t few = collection.rays < scale.ready ? 1 : 0;
  return std::min<std::uint32_t>(ringbus::PriorityLists::kBuckets - 1, 2u * collection.depth + few);
}

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("broad policy", "1.0", [](carousel::PluginParts& parts) {
    ringbus::bring_policy(parts, "broad_first", {.policy = {}, .bucket = broad_first, .newest_first = false});
  });
  return &info;
}

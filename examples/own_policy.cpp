// A policy of one's own: which collection of rays a resource issues next, beside the built-in ones, in cycles.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "core/types/enum_names.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/resource/collections/issue_policy.h"
#include "ringbus/resource/collections/priority_lists.h"

namespace {

namespace app = carousel::app;
namespace ringbus = carousel::ringbus;

/// Collections near the root first, and of those at one depth the ones with many rays: new rays are spread over the
/// machine before old ones are finished. The lowest bucket goes first.
std::uint32_t broad_first(const ringbus::CollectionFacts& collection, const ringbus::PolicyScale& scale) {
  const std::uint32_t few = collection.rays < scale.ready ? 1 : 0;
  return std::min<std::uint32_t>(ringbus::PriorityLists::kBuckets - 1, 2u * collection.depth + few);
}

}  // namespace

int main() {
  app::Prepared prepared = app::prepare_config(
      "{scene: {builtin: instances, instances: 50}, image: {width: 32, height: 32, max_depth: 2},"
      " engine: {kind: cycle}, topology: {resources: 4}}",
      "own_policy.yaml");

  std::vector<std::pair<std::string, carousel::Policy>> policies;
  for (const auto& entry : carousel::kEnumNames<carousel::Policy>) policies.emplace_back(entry.name, entry.value);
  policies.emplace_back("broad_first (own)",
                        ringbus::register_policy({.policy = {}, .bucket = broad_first, .newest_first = false}));

  std::string hits;
  bool same = true;
  for (const auto& [name, policy] : policies) {
    prepared.located.config.collections.policy = policy;
    const app::RenderJob job(prepared);
    const ringbus::RunResult result =
        ringbus::run_cycle(prepared.config(), prepared.accel, prepared.scene_size(), job.workload(), {});
    std::printf("%-18s %8llu cycles for %llu rays\n", name.c_str(),
                static_cast<unsigned long long>(result.cycle->cycles),
                static_cast<unsigned long long>(result.rays_completed));
    same = same && (hits.empty() || hits == job.hits_digest());
    hits = job.hits_digest();
  }
  std::printf("%s\n", same ? "The hits are the same with every policy." : "The hits DIFFER.");
  return same ? 0 : 1;
}

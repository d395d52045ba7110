#include "ringbus/cycle/tile/walk/subtree_walk.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

void SubtreeWalk::trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) {
  ways_.steps.clear();
  ways_.ends.clear();
  inverted_.clear();
  for (std::size_t i = 0; i < members.count; ++i) {
    walk_ray(from, {members.records, members.slots + i, 1, members.culls},
             members.any_hit_calls == nullptr ? nullptr : members.any_hit_calls + i, counts);
    ways_.ends.push_back(static_cast<std::uint32_t>(ways_.steps.size()));
  }
}

void SubtreeWalk::walk_ray(accel::NodeKey from, const accel::RayMembers& ray, std::uint8_t* any_hit_calls,
                           IntersectionCounts& counts) {
  const RayRecord& record = ray.records[*ray.slots];
  walk_.start(from);
  while (const std::optional<accel::NodeKey> key = walk_.next(record)) {
    IntersectionCounts tests = walk_.test(accel_, *key, ray);
    ways_.steps.push_back({*key, ray_tests(tests)});
    // One inversion serves all rays of a visit.
    if (tests.inversions > 0 && !inverted_.insert(key->instance).second) tests.inversions = tests.full_inversions = 0;
    if (any_hit_calls != nullptr)
      *any_hit_calls = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, *any_hit_calls + tests.any_hit_calls));
    counts += tests;
  }
}

}  // namespace carousel::ringbus::cycle

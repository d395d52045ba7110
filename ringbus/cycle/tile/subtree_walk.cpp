#include "ringbus/cycle/tile/subtree_walk.h"

#include <algorithm>

#include "ringbus/cycle/testers/unit_passes.h"

namespace carousel::ringbus::cycle {

void SubtreeWalk::trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) {
  account_.chain = 0;
  account_.strips.clear();
  account_.instances.clear();
  entered_.clear();
  std::fill(seen_.begin(), seen_.end(), 0);
  for (std::size_t i = 0; i < members.count; ++i)
    account_.chain = std::max(account_.chain,
                              walk_ray(from, {members.records, members.slots + i, 1, members.culls},
                                       members.any_hit_calls == nullptr ? nullptr : members.any_hit_calls + i, counts));
}

std::uint64_t SubtreeWalk::walk_ray(accel::NodeKey from, const accel::RayMembers& ray, std::uint8_t* any_hit_calls,
                                    IntersectionCounts& counts) {
  const RayRecord& record = ray.records[*ray.slots];
  std::uint64_t cycles = 0;
  walk_.start(from);
  while (const std::optional<accel::NodeKey> key = walk_.next(record)) {
    note(*key);
    IntersectionCounts tests = walk_.test(accel_, *key, ray);
    if (tests.transforms > 0 && !entered_.insert(key->instance).second)
      tests.inversions = 0;  // another ray's visit has done it
    else if (tests.transforms > 0)
      account_.instances.push_back(key->instance);
    for (const UnitKindRow& row : kUnitKinds) {
      const std::uint64_t passes = passes_of(row.kind, tests);
      cycles += (row.stage == Stage::kTransform ? passes : std::uint64_t{passes > 0}) * step_[row.kind];
    }
    if (any_hit_calls != nullptr)
      *any_hit_calls = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, *any_hit_calls + tests.any_hit_calls));
    counts += tests;
  }
  return cycles;
}

void SubtreeWalk::note(accel::NodeKey key) {
  // Open addressing, at most half full.
  if (seen_.size() < 2 * (account_.strips.size() + 1)) {
    seen_.assign(std::max<std::size_t>(64, 2 * seen_.size()), 0);
    for (std::uint32_t i = 0; i < account_.strips.size(); ++i) {
      std::size_t at = (account_.strips[i].ref.bits() * 0x9e3779b1u >> 7) & (seen_.size() - 1);
      while (seen_[at] != 0) at = (at + 1) & (seen_.size() - 1);
      seen_[at] = i + 1;
    }
  }
  std::size_t at = (key.ref.bits() * 0x9e3779b1u >> 7) & (seen_.size() - 1);
  for (; seen_[at] != 0; at = (at + 1) & (seen_.size() - 1))
    if (account_.strips[seen_[at] - 1].ref == key.ref) return;
  account_.strips.push_back(key);
  seen_[at] = static_cast<std::uint32_t>(account_.strips.size());
}

}  // namespace carousel::ringbus::cycle

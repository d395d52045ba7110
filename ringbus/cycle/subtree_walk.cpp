#include "ringbus/cycle/subtree_walk.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace carousel::ringbus::cycle {

void SubtreeWalk::trace(accel::NodeKey from, const accel::RayMembers& members, TestCounts& counts) {
  account_.chain = 0;
  account_.strips.clear();
  std::fill(seen_.begin(), seen_.end(), 0);
  for (std::size_t i = 0; i < members.count; ++i)
    account_.chain = std::max(account_.chain, walk_ray(from, {members.records, members.slots + i, 1}, counts));
}

std::uint64_t SubtreeWalk::walk_ray(accel::NodeKey from, const accel::RayMembers& ray, TestCounts& counts) {
  const RayRecord& record = ray.records[*ray.slots];
  std::uint64_t cycles = 0;
  std::uint32_t instance = kNoInstance;
  stack_.assign(1, {from, 0, 0, true});
  while (!stack_.empty() && (record.tag.flags & accel::kRayDone) == 0) {
    const NextNode top = stack_.back();
    stack_.pop_back();
    if (top.entry > record.hit.t) continue;
    note(top.key);
    std::uint8_t mask = 0;
    float nearest[accel::kMaxWidth], entry[accel::kMaxWidth];
    std::fill(std::begin(nearest), std::end(nearest), kInfinity);
    TestCounts tests;
    accel::test_strip(accel_, top.key, ~0u, ray, {&mask, nearest, entry}, tests);
    // The kernel transforms the ray for every strip; a walk keeps it while it stays within the instance.
    if (top.key.instance == instance) tests.transforms = 0;
    instance = top.key.instance;
    cycles += (top.key.ref.is_inner() ? step_.box : step_.triangle) + tests.transforms * step_.transform;
    counts += tests;
    if (!top.key.ref.is_inner()) continue;
    // Farthest first, so that the nearest ends on top.
    const std::size_t first = stack_.size();
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      stack_.push_back({accel_.child_key(top.key, lane), entry[lane], 0, true});
      for (std::size_t i = stack_.size() - 1; i > first && stack_[i].entry > stack_[i - 1].entry; --i)
        std::swap(stack_[i], stack_[i - 1]);
    }
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

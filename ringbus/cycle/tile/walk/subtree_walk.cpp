#include "ringbus/cycle/tile/walk/subtree_walk.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

namespace {

accel::RayMembers one_of(const accel::RayMembers& members, std::size_t i) {
  return {members.records, members.slots + i, 1, members.culls, members.any_hit_calls};
}

}  // namespace

void SubtreeWalk::begin() {
  ways_.clear();
  inverted_.clear();
}

void SubtreeWalk::trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) {
  begin();
  for (std::size_t i = 0; i < members.count; ++i) {
    walk_.start(from);
    walk_ray(one_of(members, i), counts);
  }
}

void SubtreeWalk::trace_treelets(std::span<const accel::NodeKey> from, const accel::RayMembers& members,
                                 std::vector<PacketExit>& exits, IntersectionCounts& counts) {
  begin();
  for (std::size_t i = 0; i < members.count; ++i) {
    walk_.start(from[i], accel_.pieces.get());
    walk_ray(one_of(members, i), counts);
    for (const NextNode& exit : walk_.exits()) exits.push_back({static_cast<std::uint32_t>(i), exit});
  }
}

void SubtreeWalk::walk_ray(const accel::RayMembers& ray, IntersectionCounts& counts) {
  const RayRecord& record = ray.records[*ray.slots];
  RayTests before = ray_tests(counts);
  while (const std::optional<accel::NodeKey> key = walk_.next(record)) {
    const std::uint64_t inversions = counts.inversions, full = counts.full_inversions,
                        in_double = counts.inversions_in_double;
    walk_.test(accel_, *key, ray, counts);
    RayTests after = ray_tests(counts);
    ways_.add(*key, before, after);
    // One inversion serves all rays of a visit.
    if (counts.inversions != inversions && !inverts_first(key->instance)) {
      counts.inversions = inversions;
      counts.full_inversions = full;
      counts.inversions_in_double = in_double;
      after = ray_tests(counts);
    }
    before = after;
  }
  ways_.end_ray();
}

/// Returns whether no ray before had the instance's matrix inverted. A visit meets few instances.
bool SubtreeWalk::inverts_first(std::uint32_t instance) {
  if (std::find(inverted_.begin(), inverted_.end(), instance) != inverted_.end()) return false;
  inverted_.push_back(instance);
  return true;
}

}  // namespace carousel::ringbus::cycle

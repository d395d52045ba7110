#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "core/types/ids.h"
#include "ringbus/rays/ray_group.h"

namespace carousel::ringbus {

/// Groups whose rays' data are under way to other ranks. A group may be issued when each of these ranks has taken so
/// many rays. Groups are issued in their order. Any thread may add one, and one thread at a time delivers them.
class HeldGroups {
 public:
  /// Ranks, and the number of rays of this rank that each must have taken.
  using Needs = std::vector<std::pair<std::uint32_t, std::uint64_t>>;

  void add(ResourceId issuer, RayGroup&& group, Needs needs) {
    const std::lock_guard lock(mutex_);
    held_.push_back({issuer, std::move(group), std::move(needs)});
  }
  /// `taken(rank)` returns how many rays a rank has taken; `issue(issuer, group)` issues a group if there is a place
  /// for it, and returns whether there was. Returns whether a group was issued.
  template <class Taken, class Issue>
  bool deliver(const Taken& taken, const Issue& issue) {
    bool any = false;
    const std::lock_guard lock(mutex_);
    const auto ready = [&](const Held& held) {
      return std::all_of(held.needs.begin(), held.needs.end(),
                         [&](const auto& need) { return taken(need.first) >= need.second; });
    };
    for (; !held_.empty() && ready(held_.front()); held_.pop_front(), any = true)
      if (!issue(held_.front().issuer, held_.front().group)) break;
    return any;
  }
  /// Only when nothing adds or delivers.
  std::size_t size() const { return held_.size(); }

 private:
  struct Held {
    ResourceId issuer;
    RayGroup group;
    Needs needs;
  };

  std::mutex mutex_;
  std::deque<Held> held_;
};

}  // namespace carousel::ringbus

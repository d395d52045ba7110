#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "ringbus/rays/ray_id.h"
#include "ringbus/resource/resource.h"

namespace carousel::ringbus {

/// New rays that have slots and wait for room in the collection of the root, oldest first.
class Admission {
 public:
  void add(std::vector<RayId>&& ids) {
    if (!ids.empty()) waiting_.push_back(std::move(ids));
  }
  /// Admits as many rays as there is room for and calls `admitted(rays)` after each group or part of one. Returns
  /// whether any were.
  template <class Admitted>
  bool admit(Resource& resource, const Admitted& admitted) {
    bool moved = false;
    while (!waiting_.empty()) {
      std::vector<RayId>& ids = waiting_.front();
      const std::size_t count = std::min(ids.size(), resource.admissible());
      short_of_room_ = count < ids.size();
      if (count == 0) break;
      resource.admit(std::span(ids).first(count));
      admitted(std::span<const RayId>(ids).first(count));
      moved = true;
      if (short_of_room_)
        ids.erase(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count));
      else
        waiting_.pop_front();
    }
    return moved;
  }
  /// Some rays wait because storage had no room for them at the last admit().
  bool short_of_room() const { return short_of_room_ && !waiting_.empty(); }
  bool empty() const { return waiting_.empty(); }
  std::size_t rays() const {
    std::size_t rays = 0;
    for (const std::vector<RayId>& ids : waiting_) rays += ids.size();
    return rays;
  }
  void clear() { waiting_.clear(); }

 private:
  std::deque<std::vector<RayId>> waiting_;
  bool short_of_room_ = false;
};

}  // namespace carousel::ringbus

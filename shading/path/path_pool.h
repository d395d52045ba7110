#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "core/types/vec.h"
#include "shading/path/path_state.h"
#include "shading/path/volume_stack.h"

namespace carousel::shading {

/// The path states of a frame, used over and over. Each state has one slot per bounce for the contribution of the
/// shadow ray, which therefore never enters the ring. There is room only for what the frame's effects need.
class PathPool {
 public:
  /// `paths` paths are to be traced in all, at most `states` (at least 1) at a time.
  /// `shadow_slots` is the number of bounces that may send a shadow ray; `media` is true if paths go through volumes
  /// that absorb light.
  PathPool(std::size_t states, std::uint64_t paths, std::size_t shadow_slots, bool media);

  /// Limits the number of paths that are traced. Call it before the first admission.
  void set_paths(std::uint64_t paths) { paths_ = paths; }

  struct Admission {
    std::uint64_t first = 0;  ///< ordinal of the first admitted path; the others follow
    std::size_t count = 0;    ///< states appended to `indices`
  };
  /// Admits the next at most `max` paths, as far as states are free. Any thread; takes one lock.
  Admission admit(std::size_t max, std::vector<std::uint32_t>& indices);
  /// Returns states to the pool. Any thread; takes one lock, or none for an empty list.
  void release(std::span<const std::uint32_t> indices);

  PathState& state(std::uint32_t index) { return states_[index]; }
  const PathState& state(std::uint32_t index) const { return states_[index]; }
  Vec3& shadow_contribution(std::uint32_t index, std::size_t bounce) {
    return shadow_[std::size_t{index} * shadow_slots_ + bounce];
  }
  /// The volumes that the path is in. Precondition: there are media.
  VolumeStack& volumes(std::uint32_t index) { return volumes_[index]; }

 private:
  std::size_t shadow_slots_;
  std::uint64_t paths_;
  std::unique_ptr<PathState[]> states_;
  std::unique_ptr<Vec3[]> shadow_;
  std::unique_ptr<VolumeStack[]> volumes_;
  std::mutex mutex_;
  std::vector<std::uint32_t> free_;  // guarded by mutex_
  std::uint64_t admitted_ = 0;       // guarded by mutex_
};

}  // namespace carousel::shading

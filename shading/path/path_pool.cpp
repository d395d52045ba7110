#include "shading/path/path_pool.h"

#include <algorithm>

namespace carousel::shading {

PathPool::PathPool(std::size_t states, std::uint64_t paths, std::size_t shadow_slots, bool media)
    : shadow_slots_(shadow_slots), paths_(paths) {
  // Never more states than there are paths for them.
  const auto count = static_cast<std::size_t>(std::clamp<std::uint64_t>(paths, 1, std::max<std::size_t>(states, 1)));
  states_ = std::make_unique<PathState[]>(count);
  if (shadow_slots > 0) shadow_ = std::make_unique<Vec3[]>(count * shadow_slots);
  if (media) volumes_ = std::make_unique<VolumeStack[]>(count);
  free_.resize(count);
  // The lowest index comes out first, so that a small frame uses neighbouring states.
  for (std::size_t i = 0; i < count; ++i) free_[i] = static_cast<std::uint32_t>(count - 1 - i);
}

PathPool::Admission PathPool::admit(std::size_t max, std::vector<std::uint32_t>& indices) {
  const std::scoped_lock lock(mutex_);
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>({max, free_.size(), paths_ - admitted_}));
  const Admission admission{admitted_, count};
  indices.insert(indices.end(), free_.rbegin(), free_.rbegin() + static_cast<std::ptrdiff_t>(count));
  free_.resize(free_.size() - count);
  admitted_ += count;
  return admission;
}

void PathPool::release(std::span<const std::uint32_t> indices) {
  if (indices.empty()) return;
  const std::scoped_lock lock(mutex_);
  free_.insert(free_.end(), indices.begin(), indices.end());
}

}  // namespace carousel::shading

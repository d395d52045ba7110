#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "core/types/workload.h"

namespace carousel::ringbus {

/// The rays that have been handed to the ring and have not come back, so that they can be started again when what was
/// under way is lost. A ray is known by its tag, of which there is one at a time. Any thread may call.
///
/// An unfinished path goes on from its rays that are open: what it has gathered and where it has been stand in its path
/// state, which is not the ring's and is not lost. To begin it again at the camera would trace these rays and all that
/// came before them, to the same hits, and add to the path's light what it has already.
class OutstandingRays {
 public:
  /// Before the rays are submitted.
  void add(const RayBatch& rays) {
    const std::lock_guard lock(mutex_);
    for (const RayRequest& ray : rays) open_.emplace(key(ray.tag), ray);
  }
  /// When they have come back and cannot be lost any more.
  void remove(const HitBatch& done) {
    const std::lock_guard lock(mutex_);
    for (const RayResult& ray : done) open_.erase(key(ray.tag));
  }
  /// To how many paths, each a (pixel, sample), such rays belong.
  static std::uint64_t paths_of(const RayBatch& open) {
    std::uint64_t paths = 0;
    for (std::size_t i = 0; i < open.size(); ++i) paths += i == 0 || open[i].tag.path != open[i - 1].tag.path;
    return paths;
  }
  /// What is open, by path, bounce, kind and index.
  RayBatch open() const {
    const std::lock_guard lock(mutex_);
    RayBatch rays;
    for (const auto& [k, ray] : open_) rays.push_back(ray);
    std::sort(rays.begin(), rays.end(),
              [](const RayRequest& a, const RayRequest& b) { return key(a.tag) < key(b.tag); });
    return rays;
  }

 private:
  static std::uint64_t key(const RayTag& tag) {
    return std::uint64_t{tag.path} << 32 | std::uint64_t{tag.bounce} << 16 | static_cast<std::uint64_t>(tag.kind) << 8 |
           tag.index;
  }
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, RayRequest> open_;
};

}  // namespace carousel::ringbus

#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "core/types/workload.h"

namespace carousel::ringbus {

/// Remembers the rays that are in the ring, so that they can be started again when a resource has stopped and what was
/// under way is lost. A ray is known by its tag; no two rays have the same one at a time. Any thread may call.
///
/// An unfinished path goes on from its open rays: its light and its throughput stand in the path state, which is not in
/// the ring and is not lost. To begin it again at the camera would trace all of its rays to the same hits and add their
/// light twice.
class OutstandingRays {
 public:
  /// To be called before the rays are submitted.
  void add(const RayBatch& rays) {
    const std::lock_guard lock(mutex_);
    for (const RayRequest& ray : rays) open_.emplace(key(ray.tag), ray);
  }
  /// To be called when the rays have come back and cannot be lost any more.
  void remove(const HitBatch& done) {
    const std::lock_guard lock(mutex_);
    for (const RayResult& ray : done) open_.erase(key(ray.tag));
  }
  /// How many paths, each a (pixel, sample), these rays of open() belong to.
  static std::uint64_t paths_of(const RayBatch& open) {
    std::uint64_t paths = 0;
    for (std::size_t i = 0; i < open.size(); ++i) paths += i == 0 || open[i].tag.path != open[i - 1].tag.path;
    return paths;
  }
  /// The open rays, sorted by path, bounce, kind and index.
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

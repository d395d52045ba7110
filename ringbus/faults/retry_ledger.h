#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <unordered_map>

#include "core/workload.h"

namespace carousel::ringbus {

/// The rays that have been handed to the ring and not been shaded, so that they can be started again when what was
/// under way is lost. A ray is known by its tag, of which there is one at a time. Any thread may call.
class RetryLedger {
 public:
  /// Before the rays are submitted.
  void add(const RayBatch& rays) {
    const std::lock_guard lock(mutex_);
    for (const RayRequest& ray : rays) open_.emplace(key(ray.tag), ray);
  }
  /// After they have been shaded.
  void remove(const HitBatch& done) {
    const std::lock_guard lock(mutex_);
    for (const RayResult& ray : done) open_.erase(key(ray.tag));
  }
  /// What is open, by path, bounce, kind and index.
  RayBatch open() const {
    const std::lock_guard lock(mutex_);
    RayBatch rays;
    for (const auto& [k, ray] : open_) rays.push_back(ray);
    std::sort(rays.begin(), rays.end(), [](const RayRequest& a, const RayRequest& b) { return key(a.tag) < key(b.tag); });
    return rays;
  }

 private:
  static std::uint64_t key(const RayTag& tag) {
    return std::uint64_t{tag.path} << 32 | std::uint64_t{tag.bounce} << 16 | static_cast<std::uint64_t>(tag.kind) << 8 | tag.index;
  }
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, RayRequest> open_;
};

}  // namespace carousel::ringbus

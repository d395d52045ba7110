#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "core/system/error.h"
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
  /// To be called before the rays are submitted. Throws a SimulationError if one of them is outstanding already.
  void add(const RayBatch& rays) {
    const std::lock_guard lock(mutex_);
    for (const RayRequest& ray : rays)
      if (!open_.emplace(key(ray.tag), ray).second) fail(ray.tag, "begins while it is outstanding");
  }
  /// To be called when the rays have come back and cannot be lost any more, and before they are given to
  /// Workload::shade(), which may use their paths' numbers for new rays at once. Throws a SimulationError if one of
  /// them is not outstanding.
  void remove(const HitBatch& done) {
    const std::lock_guard lock(mutex_);
    for (const RayResult& ray : done)
      if (open_.erase(key(ray.tag)) == 0) fail(ray.tag, "has come back and is not outstanding");
  }
  /// How many paths, each a (pixel, sample), these rays of open() belong to.
  static std::uint64_t paths_of(const RayBatch& open) {
    std::uint64_t paths = 0;
    for (std::size_t i = 0; i < open.size(); ++i) paths += i == 0 || open[i].tag.path != open[i - 1].tag.path;
    return paths;
  }
  /// The open rays but those in `handed_over`, sorted by path, bounce, kind and index.
  RayBatch open(std::span<const HitBatch> handed_over = {}) const {
    std::unordered_set<std::uint64_t> safe;
    for (const HitBatch& batch : handed_over)
      for (const RayResult& ray : batch) safe.insert(key(ray.tag));
    const std::lock_guard lock(mutex_);
    RayBatch rays;
    for (const auto& [k, ray] : open_)
      if (!safe.contains(k)) rays.push_back(ray);
    std::sort(rays.begin(), rays.end(),
              [](const RayRequest& a, const RayRequest& b) { return key(a.tag) < key(b.tag); });
    return rays;
  }

 private:
  static std::uint64_t key(const RayTag& tag) {
    return std::uint64_t{tag.path} << 32 | std::uint64_t{tag.bounce} << 16 | static_cast<std::uint64_t>(tag.kind) << 8 |
           tag.index;
  }
  [[noreturn]] static void fail(const RayTag& tag, const char* what) {
    throw SimulationError(fmt::format("the ray of path {}, bounce {}, kind {}, index {} {}", tag.path, tag.bounce,
                                      static_cast<int>(tag.kind), tag.index, what));
  }
  mutable std::mutex mutex_;
  std::unordered_map<std::uint64_t, RayRequest> open_;
};

}  // namespace carousel::ringbus

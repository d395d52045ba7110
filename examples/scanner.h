#pragma once

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/types/workload.h"

namespace scanner {

using namespace carousel;

constexpr float kPi = 3.14159265f;

/// No picture, but a range scanner that turns in the middle of a scene. Each beam that meets a surface is reflected
/// once. The plugin own_workload.cpp and the program own_program.cpp use it.
class Scanner final : public Workload {
 public:
  Scanner(Vec3 place, std::uint32_t beams) : place_(place), beams_(beams), distance_(beams, kInfinity) {}

  /// Engines ask several workers at a time; each call takes the next beams.
  Generated generate(WorkerId, std::size_t most, RayBatch& out) override {
    Generated made;
    for (; made.rays < most; ++made.rays) {
      const std::uint32_t beam = next_.fetch_add(1, std::memory_order_relaxed);
      if (beam >= beams_) break;
      RayRequest request;
      request.ray = {.origin = place_, .tmin = 0, .direction = direction(beam), .tmax = kInfinity};
      request.tag.path = beam;
      out.push_back(request);
    }
    made.finished = next_.load(std::memory_order_relaxed) >= beams_;
    return made;
  }

  /// Every ray comes back once. A beam has places of its own, so workers do not meet.
  void shade(WorkerId, const HitBatch& completed, RayBatch& out) override {
    for (const RayResult& result : completed) {
      if (result.tag.kind != RayKind::kCamera || !result.hit.valid()) continue;
      distance_[result.tag.path] = result.hit.t;
      RayRequest back;  // sent on sideways, from a little above the surface
      const Vec3 along = result.ray.direction;
      back.ray = {.origin = result.ray.origin + along * (0.999f * result.hit.t),
                  .tmin = 0,
                  .direction = Vec3(-along.z, along.y, along.x),
                  .tmax = kInfinity};
      back.tag = {.path = result.tag.path, .kind = RayKind::kBounce, .bounce = 1, .index = 0, .flags = 0};
      out.push_back(back);
    }
  }

  const std::vector<float>& distances() const { return distance_; }

 private:
  /// Points of a spiral, spread evenly over the sphere.
  Vec3 direction(std::uint32_t beam) const {
    const float y = 1 - 2 * (static_cast<float>(beam) + 0.5f) / static_cast<float>(beams_);
    const float around = static_cast<float>(beam) * kPi * (3 - std::sqrt(5.0f));
    const float radius = std::sqrt(1 - y * y);
    return {radius * std::cos(around), y, radius * std::sin(around)};
  }

  Vec3 place_;
  std::uint32_t beams_;
  std::atomic<std::uint32_t> next_{0};
  std::vector<float> distance_;
};

}  // namespace scanner

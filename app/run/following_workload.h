#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/types/wrapped_workload.h"
#include "ringbus/results/ray_log.h"

namespace carousel::app {

/// The place of a ray in the frame, whatever path state its workload keeps it in.
struct RayPlace {
  std::uint32_t pixel = 0, sample = 0;
  RayKind kind = RayKind::kCamera;
  std::uint8_t bounce = 0, index = 0;
};

/// Finds one ray among those of another workload, names it for the engine, and notes what came of it. It changes
/// neither rays nor their order.
class FollowingWorkload final : public WrappedWorkload {
 public:
  using Clock = std::chrono::steady_clock;
  /// Pixel and sample of a path whose rays are in flight.
  using Locate = std::function<std::pair<std::uint32_t, std::uint32_t>(std::uint32_t path)>;

  FollowingWorkload(Workload& inner, const RayPlace& place, Locate locate, ringbus::FollowedRay& ray)
      : WrappedWorkload(inner), place_(place), locate_(std::move(locate)), ray_(ray) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  // After the run.

  /// Adds the times of the host at which the ray was made and shaded, in nanoseconds since `start`.
  void add_times(Clock::time_point start, std::vector<ringbus::RayFact>& facts) const;
  const std::optional<RayRequest>& request() const { return request_; }
  const std::optional<RayResult>& result() const { return result_; }
  /// The rays that came of it.
  const std::vector<RayTag>& caused() const { return caused_; }
  /// The last ray of the path that was made; absent if the path never began.
  const std::optional<RayTag>& last_of_path() const { return last_of_path_; }

 private:
  void look_at(const RayRequest& request);

  RayPlace place_;
  Locate locate_;
  ringbus::FollowedRay& ray_;
  std::mutex mutex_;                   // guards all below
  std::optional<std::uint32_t> path_;  // path of the pixel's sample, while it is in flight
  std::optional<RayTag> last_of_path_;
  std::optional<RayRequest> request_;
  std::optional<RayResult> result_;
  std::vector<RayTag> caused_;
  Clock::time_point made_{}, shade_began_{}, shaded_{};
};

}  // namespace carousel::app

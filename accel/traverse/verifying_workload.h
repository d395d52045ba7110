#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>

#include "accel/traverse/hit_oracle.h"
#include "core/types/wrapped_workload.h"

namespace carousel::accel {

/// A workload that compares the hit of every completed ray of another one with the oracle's, bit by bit
/// (`verify: reference`). Shadow rays are compared by occluded or visible. Same threads as the workload.
class VerifyingWorkload final : public WrappedWorkload {
 public:
  /// Keeps references to both.
  VerifyingWorkload(Workload& inner, const HitOracle& oracle) : WrappedWorkload(inner), oracle_(oracle) {}

  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;

  /// Compares the hits of a ray that looks for several (`rays.query.nearest`) with the oracle's, as many as `nearest`.
  void compare_nearest(const RayResult& ray, std::span<const Hit> hits);
  void set_nearest(std::size_t nearest) { nearest_ = nearest; }

  struct Mismatch {
    RayResult got, expected;
  };
  std::uint64_t compared() const { return compared_; }
  std::uint64_t mismatches() const { return mismatches_; }
  /// One of the mismatches, for the error message. Call when nothing runs.
  const std::optional<Mismatch>& example() const { return example_; }

 private:
  void note(const RayResult& got, const RayResult& expected);

  const HitOracle& oracle_;
  std::size_t nearest_ = 0;
  std::atomic<std::uint64_t> compared_{0}, mismatches_{0};
  std::mutex example_mutex_;
  std::optional<Mismatch> example_;
};

/// True if two results of one ray are the same to the bit (for shadow rays: if they agree on occlusion).
bool same_result(const RayResult& a, const RayResult& b);

}  // namespace carousel::accel

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

#include "accel/traverse/verifying_workload.h"
#include "core/types/hit_sink.h"
#include "core/types/nearest_sink.h"

namespace carousel::app {

/// All hits of a file's rays (`rays.query: all`), each once: nearest first, then by instance, primitive, u and v. The
/// hits of a traced ray are a set, so a ray that is traced again, by another run as well, adds nothing.
class AllHits final : public HitSink {
 public:
  /// A ray may have `most` hits.
  explicit AllHits(std::size_t most) : most_(most) {}

  /// Throws a SimulationError if the ray has more hits than it may.
  void add(std::uint32_t path, const Hit& hit) override;

  std::vector<Hit> of(std::uint32_t path) const;

 private:
  struct alignas(64) Shard {   // rays are spread over several, so that threads seldom wait for one another
    mutable std::mutex mutex;  // guards `hits`
    std::unordered_map<std::uint32_t, std::vector<Hit>> hits;  // by path, sorted
  };
  const std::size_t most_;
  std::array<Shard, 64> shards_;
};

/// Where rays that look for several hits leave them: beside those of a file's rays, and at the judge of the run.
class NearestHits final : public NearestSink {
 public:
  /// `list`: takes hits by the path of their ray; null if the rays are of no file.
  explicit NearestHits(AllHits* list) : list_(list) {}

  /// From now on the hits of every ray are compared; null: no longer. Call while nothing runs.
  void judge_by(accel::VerifyingWorkload* judge) { judge_ = judge; }

  void add(const RayResult& ray, std::span<const Hit> hits) override {
    if (list_ != nullptr)
      for (const Hit& hit : hits) list_->add(ray.tag.path, hit);
    if (judge_ != nullptr) judge_->compare_nearest(ray, hits);
  }

 private:
  AllHits* const list_;
  accel::VerifyingWorkload* judge_ = nullptr;
};

}  // namespace carousel::app

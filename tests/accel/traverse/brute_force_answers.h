#pragma once

#include <cstddef>
#include <vector>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "accel/traverse/reference_tracer.h"
#include "accel/traverse/verifying_workload.h"
#include "tests/accel/traverse/brute_force.h"

namespace carousel::accel {

/// The answers of testing every triangle in scalar code, with which those of structures are compared.
class BruteForceAnswers {
 public:
  BruteForceAnswers(const scene::Scene& scene, const RayBatch& rays, const AccuracyConfig& accuracy = {},
                    const AnyHit* any_hit = nullptr)
      : rays_(rays) {
    for (const RayRequest& ray : rays)
      expected_.push_back({ray.ray, brute_force(scene, ray, accuracy, any_hit), ray.tag});
  }
  /// How many answers of the structure are others, one ray after another, interleaved and in lists.
  std::size_t differences(const Accel& accel) const {
    std::size_t differences = 0;
    for (auto* const tracer : {trace_depth_first, trace_depth_first_interleaved, trace_in_lists}) {
      HitBatch got;
      IntersectionCounts counts;
      tracer(accel, rays_, got, counts);
      for (std::size_t i = 0; i < expected_.size(); ++i) differences += !same_result(expected_[i], got.at(i));
    }
    return differences;
  }
  std::size_t hits() const {
    std::size_t hits = 0;
    for (const RayResult& r : expected_) hits += r.hit.valid();
    return hits;
  }

 private:
  static void trace_in_lists(const Accel& accel, const RayBatch& rays, HitBatch& out, IntersectionCounts& counts) {
    std::vector<RayRecord> records(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) start_record(rays[i], records[i]);
    trace_stream(accel, accel.root_key(), {.records = records.data(), .count = records.size()}, counts);
    for (const RayRecord& record : records) finish_record(record, out);
  }

  RayBatch rays_;
  HitBatch expected_;
};

}  // namespace carousel::accel

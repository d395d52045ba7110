#include "app/run/ray_list_workload.h"

#include <algorithm>

namespace carousel::app {

Workload::Generated RayListWorkload::generate(WorkerId worker, std::size_t max_rays, RayBatch& out) {
  // Relaxed: the cursor assigns disjoint ranges of a list that is only read.
  const std::size_t all = sample_ == nullptr ? rays_.size() : sample_->count();
  std::size_t begin = next_.load(std::memory_order_relaxed), end = begin;
  do {
    end = begin + std::min(max_rays, all - begin);
  } while (!next_.compare_exchange_weak(begin, end, std::memory_order_relaxed));
  for (std::size_t i = begin; i < end; ++i) {
    const RayRequest& ray = rays_[sample_ == nullptr ? i : sample_->ordinal(i)];
    out.push_back(ray);
    ++workers_[worker.value].emitted[static_cast<std::size_t>(ray.tag.kind)];
  }
  return {end - begin, end == all};
}

void RayListWorkload::shade(WorkerId worker, const HitBatch& completed, RayBatch&) {
  for (const RayResult& result : completed) {
    if (all_ != nullptr && !takes_any_hit(result.tag)) {
      take_all(worker, result);
      continue;
    }
    workers_[worker.value].digest.add(hit_term(result.tag.path, 0, result.tag, result.hit));
    if (recorder_) recorder_->record(worker, result.tag.path, 0, result);
  }
}

void RayListWorkload::take_all(WorkerId worker, const RayResult& result) {
  std::vector<Hit> hits = all_->of(result.tag.path);
  if (hits.empty()) hits.push_back(result.hit);  // a miss
  RayResult row = result;
  row.tag.flags |= kRayAll;  // a row a hit
  for (std::uint32_t k = 0; k < hits.size(); ++k) {
    row.hit = hits[k];
    workers_[worker.value].digest.add(hit_term(result.tag.path, k, result.tag, row.hit));
    if (recorder_) recorder_->record(worker, result.tag.path, k, row);
  }
}

std::array<std::uint64_t, kRayKinds> RayListWorkload::emitted() const {
  std::array<std::uint64_t, kRayKinds> sum{};
  for (const Worker& worker : workers_)
    for (std::size_t kind = 0; kind < sum.size(); ++kind) sum[kind] += worker.emitted[kind];
  return sum;
}

HitsDigest RayListWorkload::hits_digest() const {
  HitsDigest sum;
  for (const Worker& worker : workers_) sum.add(worker.digest);
  return sum;
}

}  // namespace carousel::app

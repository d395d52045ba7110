#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "core/types/workload.h"
#include "tests/shading/path/brute_force_tracer.h"

namespace carousel::shading {

/// Runs a frame on `workers` threads that take rays from one bag in random order and cut random batches of at most
/// `batch`: an engine that uses all the freedom that the contract of Workload allows.
inline void run_unruly_frame(Workload& workload, const BruteForceTracer& tracer, std::size_t workers, std::size_t batch,
                             std::uint32_t seed) {
  std::mutex mutex;
  RayBatch bag;                          // guarded by mutex
  std::atomic<std::size_t> unshaded{0};  // rays in the bag or being traced or shaded
  std::atomic<bool> finished{false};
  auto work = [&](std::uint32_t id) {
    std::minstd_rand random(seed + id);
    RayBatch rays;
    HitBatch hits;
    while (true) {
      rays.clear();
      hits.clear();
      {
        const std::scoped_lock lock(mutex);
        std::size_t count = std::min<std::size_t>(bag.size(), 1 + random() % batch);
        for (; count > 0; --count) {
          std::swap(bag[random() % bag.size()], bag.back());
          hits.push_back({bag.back().ray, {}, bag.back().tag});
          bag.pop_back();
        }
      }
      if (hits.empty() || random() % 4 == 0) {
        // Read before the count of rays: no ray can appear after "finished" but from a ray still counted.
        const bool none_to_come = finished.load();
        if (none_to_come && hits.empty()) {
          if (unshaded.load() == 0) return;
          std::this_thread::yield();
          continue;
        }
        if (!none_to_come) {
          const Workload::Generated generated = workload.generate(WorkerId(id), 1 + random() % batch, rays);
          unshaded.fetch_add(generated.rays);
          if (generated.finished) finished.store(true);
        }
      }
      for (RayResult& hit : hits) hit.hit = tracer.trace(hit.ray, hit.tag);
      const std::size_t before = rays.size();
      workload.shade(WorkerId(id), hits, rays);
      unshaded.fetch_add(rays.size() - before);
      unshaded.fetch_sub(hits.size());
      if (!rays.empty()) {
        const std::scoped_lock lock(mutex);
        bag.insert(bag.end(), rays.begin(), rays.end());
      } else if (hits.empty()) {
        std::this_thread::yield();
      }
    }
  };
  std::vector<std::jthread> threads;
  for (std::uint32_t id = 0; id < workers; ++id) threads.emplace_back(work, id);
}

}  // namespace carousel::shading

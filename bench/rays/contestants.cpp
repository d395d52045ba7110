#include "bench/rays/contestants.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "bench/common/batch_threads.h"

namespace carousel::bench {

namespace {

Work work_of(const ringbus::RunResult& result) {
  ringbus::ResourceStatistics sum;
  for (const ringbus::ResourceStatistics& one : result.resources) sum += one;
  const auto ratio = [](std::uint64_t a, std::uint64_t b) {
    return b == 0 ? 0 : static_cast<double>(a) / static_cast<double>(b);
  };
  return {ratio(sum.tests.box, sum.rays_completed), ratio(sum.tests.triangle, sum.rays_completed),
          ratio(sum.memberships, sum.rays_completed), ratio(sum.packet_rays, sum.packets_issued),
          result.complete ? 0 : std::max<std::uint64_t>(1, result.rays_completed)};
}

}  // namespace

float scene_size(const scene::Scene& scene) {
  const Vec3 extent = scene.bounds().extent();
  return std::sqrt(glm::dot(extent, extent));
}

Contest::Contest(const scene::Scene& scene, const accel::Accel& accel, const RingSettings& ring, const Field& field)
    : accel_(accel), field_(field), scene_size_(scene_size(scene)) {
  add_depth_first(kDepthFirst, accel::trace_depth_first);
  add_depth_first(kDepthFirstInterleaved, accel::trace_depth_first_interleaved);
  add_treelet_rings("", ring, false);
  for (const std::string& changes : field.variations)
    add_treelet_rings(", " + changes, with_changes(ring, changes), false);
  if (field.all_forms) {
    add_treelet_rings(", statistics", ring, true);
    add_ring("ring treelet, 8 owners", ring, {Traversal::kTreelet, Home::kIssuer, 8}, false);
    add_ring("ring spread, local", ring, {Traversal::kSpread, Home::kLocal}, true);
    add_ring("ring spread, 2 owners", ring, {Traversal::kSpread, Home::kIssuer, 2}, false);
    add_ring("ring ordered, local", ring, {Traversal::kOrdered, Home::kLocal}, true);
    add_ring("ring ordered, 2 owners", ring, {Traversal::kOrdered, Home::kIssuer, 2}, false);
  }
  add_embree(scene, true);
  add_embree(scene, false);
}

void Contest::add_treelet_rings(const std::string& suffix, const RingSettings& settings, bool statistics) {
  add_ring(kTreeletLocal + suffix, settings, {Traversal::kTreelet, Home::kLocal, 1, statistics}, true);
  add_ring(kTreeletOwners + suffix, settings, {Traversal::kTreelet, Home::kIssuer, 2, statistics}, false);
}

void Contest::add(Contestant contestant) {
  if (contestant.name.find(field_.only) != std::string::npos) contestants_.push_back(std::move(contestant));
}

void Contest::add_depth_first(const char* name, decltype(accel::trace_depth_first)& trace) {
  add({name, true, [this, &trace](const RaySet& rays, int threads, HitList& hits) {
         std::atomic<std::uint64_t> boxes{0}, triangles{0};
         for_each_batch(rays, threads, [&] {
           return [&, found = HitBatch()](const RayBatch& batch) mutable {
             found.clear();
             IntersectionCounts counts;
             trace(accel_, batch, found, counts);
             for (const RayResult& result : found) hits[result.tag.path] = result.hit;
             // Relaxed: the sums are read when the threads have been joined.
             boxes.fetch_add(counts.box, std::memory_order_relaxed);
             triangles.fetch_add(counts.triangle, std::memory_order_relaxed);
           };
         });
         const double count = static_cast<double>(rays.size);
         return Work{static_cast<double>(boxes) / count, static_cast<double>(triangles) / count, 0, 0, 0};
       }});
}

void Contest::add_ring(const std::string& name, const RingSettings& settings, const RingForm& form,
                       bool resource_a_thread) {
  add({name, true, [this, settings, form, resource_a_thread](const RaySet& rays, int threads, HitList& hits) {
         RingForm placed = form;
         if (resource_a_thread) placed.resources = threads;
         const RingRun run = run_ring(accel_, scene_size_, settings, placed, rays, threads, hits);
         return work_of(run.result);
       }});
}

void Contest::add_embree(const scene::Scene& scene, bool robust) {
  const std::string single = robust ? kEmbreeRobust : "Embree default, single";
  const std::string sixteen = robust ? "Embree robust, 16-wide" : "Embree default, 16-wide";
  if (single.find(field_.only) == std::string::npos && sixteen.find(field_.only) == std::string::npos) return;
  const auto peer =
      std::make_shared<EmbreePeer>(scene, EmbreeSettings{robust, field_.quality, field_.frequency_level, 1});
  add({single, false, [peer](const RaySet& rays, int threads, HitList& hits) {
         peer->trace_single(rays, threads, hits);
         return Work{};
       }});
  if (!field_.all_forms) return;
  add({sixteen, false, [peer](const RaySet& rays, int threads, HitList& hits) {
         peer->trace_sixteen(rays, threads, hits);
         return Work{};
       }});
}

}  // namespace carousel::bench

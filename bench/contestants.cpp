#include "bench/contestants.h"

#include <cmath>

#include "accel/reference_tracer.h"
#include "bench/batch_threads.h"

namespace carousel::bench {

float scene_size(const scene::Scene& scene) {
  const Vec3 extent = scene.bounds().extent();
  return std::sqrt(glm::dot(extent, extent));
}

Contest::Contest(const scene::Scene& scene, const accel::Accel& accel, const RingSettings& ring,
                 const Field& field)
    : accel_(accel), ring_(ring), field_(field), scene_size_(scene_size(scene)) {
  add_depth_first();
  add_ring(kTreeletLocal, {.traversal = Traversal::kTreelet, .home = Home::kLocal}, true);
  add_ring(kTreeletOwners, {.traversal = Traversal::kTreelet, .home = Home::kIssuer, .resources = 2}, false);
  if (field.all_forms) {
    add_ring("ring treelet, local, statistics",
             {.traversal = Traversal::kTreelet, .home = Home::kLocal, .statistics = true}, true);
    add_ring("ring treelet, 2 owners, statistics",
             {.traversal = Traversal::kTreelet, .home = Home::kIssuer, .resources = 2, .statistics = true},
             false);
    add_ring("ring treelet, 8 owners",
             {.traversal = Traversal::kTreelet, .home = Home::kIssuer, .resources = 8}, false);
    add_ring("ring spread, local", {.traversal = Traversal::kSpread, .home = Home::kLocal}, true);
    add_ring("ring spread, 2 owners",
             {.traversal = Traversal::kSpread, .home = Home::kIssuer, .resources = 2}, false);
    add_ring("ring ordered, local", {.traversal = Traversal::kOrdered, .home = Home::kLocal}, true);
    add_ring("ring ordered, 2 owners",
             {.traversal = Traversal::kOrdered, .home = Home::kIssuer, .resources = 2}, false);
  }
  add_embree(scene, true);
  add_embree(scene, false);
}

void Contest::add(Contestant contestant) {
  if (contestant.name.find(field_.only) != std::string::npos) contestants_.push_back(std::move(contestant));
}

void Contest::add_depth_first() {
  add({kDepthFirst, true, [this](const RaySet& rays, int threads, HitList& hits) {
         for_each_batch(rays, threads, [&] {
           return [&, found = HitBatch(), counts = TestCounts()](const RayBatch& batch) mutable {
             found.clear();
             accel::trace_depth_first(accel_, batch, found, counts);
             for (const RayResult& result : found) hits[result.tag.path] = result.hit;
           };
         });
       }});
}

void Contest::add_ring(const std::string& name, const RingForm& form, bool resource_a_thread) {
  add({name, true, [this, form, resource_a_thread](const RaySet& rays, int threads, HitList& hits) {
         RingForm placed = form;
         if (resource_a_thread) placed.resources = threads;
         run_ring(accel_, scene_size_, ring_, placed, rays, threads, hits);
       }});
}

void Contest::add_embree(const scene::Scene& scene, bool robust) {
  const std::string single = robust ? kEmbreeRobust : "Embree default, single";
  const std::string sixteen = robust ? "Embree robust, 16-wide" : "Embree default, 16-wide";
  if (single.find(field_.only) == std::string::npos && sixteen.find(field_.only) == std::string::npos) return;
  const auto peer =
      std::make_shared<EmbreePeer>(scene, EmbreeSettings{robust, field_.quality, field_.frequency_level, 1});
  add({single, false,
       [peer](const RaySet& rays, int threads, HitList& hits) { peer->trace_single(rays, threads, hits); }});
  if (!field_.all_forms) return;
  add({sixteen, false,
       [peer](const RaySet& rays, int threads, HitList& hits) { peer->trace_sixteen(rays, threads, hits); }});
}

}  // namespace carousel::bench

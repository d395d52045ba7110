// The effect of a link's queue, and of counting its packets, on the whole: the native engine on a ring with small
// packets, so that the links have much to do. Items are rays.
#include <map>
#include <stdexcept>
#include <string>

#include <benchmark/benchmark.h>

#include "accel/builders/build.h"
#include "bench/common/ring_runner.h"
#include "bench/common/scenes.h"
#include "bench/queues/queue_benchmarks.h"
#include "core/config/config.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"

namespace carousel::bench {

namespace {

struct Course {
  scene::Scene scene = make_scene({"terrain", 100'000, ""});
  accel::Accel accel = accel::build(scene, {}, *make_tbb_executor(2));
  float size = glm::length(scene.bounds().extent());
  RaySet rays = ray_set(make_ray_sets(scene, accel, 256, 1));

 private:
  static RaySet ray_set(std::vector<RaySet> sets) {
    for (RaySet& set : sets)
      if (set.name == "bounce") return std::move(set);
    throw std::logic_error("no set of bounced rays");
  }
};

enum class Count { kNothing, kEvents, kEventsAndLinks };

void trace(benchmark::State& state, QueueKind queue, Count count) {
  static const Course course;
  RingSettings settings;
  settings.queue = queue;
  settings.packet_rays = 32;
  settings.ready = 32;
  settings.link_depth = state.range(0);
  HitList hits(course.rays.size);
  for (auto _ : state) {
    const RingRun run = run_ring(course.accel, course.size, settings,
                                 {.home = Home::kIssuer,
                                  .resources = 4,
                                  .statistics = count != Count::kNothing,
                                  .link_statistics = count == Count::kEventsAndLinks},
                                 course.rays, 2, hits);
    if (!run.result.complete) state.SkipWithError("the run was not complete");
    state.SetIterationTime(run.result.wall_seconds);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(course.rays.size));
}

void enter(QueueKind queue, const std::string& counted, Count count) {
  const std::string name = "ring/" + std::string(enum_name(queue)) + counted;
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) { trace(s, queue, count); })
      ->ArgName("depth")
      ->Arg(1)
      ->Arg(16)
      ->UseManualTime();
}

}  // namespace

void enter_ring_queues() {
  for (const EnumName<QueueKind>& kind : kEnumNames<QueueKind>) enter(kind.value, "", Count::kNothing);
  enter(QueueKind::kSpscRing, "/events", Count::kEvents);
  enter(QueueKind::kSpscRing, "/events+links", Count::kEventsAndLinks);
}

}  // namespace carousel::bench

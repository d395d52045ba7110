// The cycles of a run end with its last event, however long the windows are in which agents run by themselves.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::run_end_test {
namespace {

class RunEnd : public TimedRun {
 protected:
  /// Cycles of a run in which one ray is made, misses the only triangle, and is shaded.
  std::uint64_t one_ray(std::int64_t hop, int threads) {
    program_.write("ray.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n");
    return report(
        "scene: {builtin: terrain, triangles: 600}\n"
        "workload: {rays_from: ray.csv}\n"
        "rays: {slots_per_resource: 8}\n"
        "shading: {workers: 1, cycles_per_shade: 30}\n"
        "memory: {l2_latency_cycles: 4000, dram_latency_cycles: 4000}\n",
        {"topology.resources=2", "collections.home=local", fmt::format("topology.link.latency_cycles={}", hop),
         fmt::format("engine.threads={}", threads)})["engine"]["cycles"];
  }
};

TEST_F(RunEnd, IsTheCycleAfterTheLastRayWasShaded) {
  const std::uint64_t near = one_ray(1, 1);
  for (const std::int64_t hop : {1, 10, 1000}) {
    // The ray crosses two wires as long as a hop: with its record, and when it is complete.
    EXPECT_EQ(one_ray(hop, 1), near + 2 * static_cast<std::uint64_t>(hop - 1)) << hop;
    EXPECT_EQ(one_ray(hop, 2), one_ray(hop, 1)) << hop;
  }
}

}  // namespace
}  // namespace carousel::run_end_test

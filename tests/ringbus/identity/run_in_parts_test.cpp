// A run that goes on in parts is the run: machines drawn at random take the same cycles, and shade the same hits, on
// one thread and on two.
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "ringbus/cycle/cycle_engine.h"
#include "tests/ringbus/identity/machine_space.h"
#include "tests/ringbus/identity/scenes.h"
#include "tests/ringbus/support/watchdog.h"

namespace carousel::ringbus {
namespace {

struct Parted {
  RunResult result;
  std::string digest;
};

/// Stops after each of so many equal parts of the rays.
Parted run_in(std::uint64_t parts, TestScene& scene, const Cell& cell, std::size_t threads) {
  const accel::Accel& accel = scene.accel(cell.config.bvh, cell.config.cull_planes, cell.config.accuracy);
  ScatterWorkload workload = scene.workload();
  RunOptions options = on_threads(threads);
  options.stop = cell.stop;
  const std::uint64_t rays = scene.reference(cell.config.accuracy).rays;
  const std::unique_ptr<CycleSimulation> run = begin_cycle(cell.config, accel, scene.size(), workload, options);
  for (std::uint64_t part = 1; part < parts; ++part) {
    const std::uint64_t wanted = rays * part / parts;
    if (run->run_until(wanted)) continue;  // few rays complete at once at the end
    EXPECT_GE(run->progress().back().completed, wanted);
  }
  EXPECT_TRUE(run->run_until(std::numeric_limits<std::uint64_t>::max()));
  Parted out{run->result(), {}};
  out.digest = workload.digest().hex();
  return out;
}

TEST(RunInParts, TakesTheCyclesOfTheRun) {
  MachineSpace& space = all_machines();
  Scenes scenes;
  const std::vector<std::string> with{"engine.kind=cycle"};
  std::mt19937 random(104729 * run_seed());
  for (int i = cell_count(40); i > 0; --i) {
    Cell cell = space.draw_cell(random, with);
    SCOPED_TRACE(cell.text());
    Watchdog watchdog(std::chrono::seconds(60), cell.text());
    cell.stop = watchdog.token();
    TestScene& scene = scenes.of(cell);
    give_room(cell, scene.accel(cell.config.bvh, cell.config.cull_planes, cell.config.accuracy));
    const Parted whole = run_in(1, scene, cell, 1);
    for (const std::size_t threads : {1, 2}) {
      const Parted parted = run_in(5, scene, cell, threads);
      EXPECT_EQ(parted.result.cycle->cycles, whole.result.cycle->cycles) << threads << " threads";
      EXPECT_EQ(parted.result.rays_completed, whole.result.rays_completed);
      EXPECT_EQ(parted.digest, whole.digest);
      EXPECT_TRUE(parted.result.complete);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus

// New rays that go round the ring in packets to find slots (`rays.placement: first_taker`, `addressed`): when they are
// where, the bytes that they take on the links, and the same picture as with every other placement.
#include <fmt/format.h>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "ringbus/cycle/cycle_engine.h"
#include "tests/app/time/timed_run.h"

namespace carousel::travelling_rays_test {
namespace {

class TravellingRays : public TimedRun {};

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 16, height: 12, samples: 1, max_depth: 3}\n"
    "topology: {resources: 4}\npackets: {rays: 8}\ncollections: {ready: 8}\nrays: {slots_per_resource: 24}\n";

TEST_F(TravellingRays, GiveTheSamePictureInEveryNetworkAndFlow) {
  const Json balanced = report(kMachine);
  for (const char* placement : {"first_taker", "addressed"})
    for (const char* set : {"topology.shape=ring", "topology.shape=bidirectional", "topology.shape=hierarchical",
                            "topology.shape=point_to_point", "topology.shape=bus", "topology.flow=bubble",
                            "topology.link.depth=1", "topology.visit=owners", "collections.home=local",
                            "topology.resources=1", "rays.slots_per_resource=1", "collections.traversal=treelet"}) {
      const Json r = report(kMachine, {fmt::format("rays.placement={}", placement), set});
      EXPECT_EQ(r["digest"], balanced["digest"]) << placement << ", " << set;
      EXPECT_EQ(r["rays"]["completed"], balanced["rays"]["completed"]);
    }
}

TEST_F(TravellingRays, TakeTheSameCyclesOnAnyNumberOfThreads) {
  for (const char* placement : {"first_taker", "addressed"}) {
    const std::vector<std::string> sets{fmt::format("rays.placement={}", placement)};
    const Json one = report(kMachine, sets);
    std::vector<std::string> more = sets;
    more.push_back("engine.threads=3");
    EXPECT_EQ(report(kMachine, more)["engine"]["epochs"], one["engine"]["epochs"]) << placement;
  }
}

// A ring of two resources and a scene whose rays all miss: the only packets on the links are those of new rays and
// those of the root.
TEST_F(TravellingRays, AreChargedOnTheLinks) {
  const char* machine =
      "scene: {builtin: terrain, triangles: 600}\nimage: {width: 2, height: 1, samples: 1, max_depth: 1}\n"
      "camera: {eye: [0, 9, 0], target: [0, 20, 1]}\n"
      "topology: {resources: 2, visit: owners}\npackets: {rays: 2}\n"
      "collections: {ready: 2, policy: fullest}\nrays: {placement: first_taker}\n";
  const Json travel = report(machine), load = report(machine, {"rays.placement=round_robin"});
  EXPECT_EQ(travel["rays"]["completed"], 2);
  // There with a record and an ID, back with two IDs.
  EXPECT_EQ(bytes(travel, "packets") - bytes(load, "packets"), (16 + 64 + 4) + (16 + 8));
  // Both records come to the first resource, without IDs.
  EXPECT_EQ(bytes(travel, "new rays"), 2 * 64u);
  EXPECT_EQ(bytes(load, "new rays"), 2 * 64u + 8);
}

// The machine of the test above is watched cycle by cycle.
TEST_F(TravellingRays, ComeToTheirSlotsInTheCyclesOfThePage) {
  const app::Prepared prepared = app::prepare_config(
      "engine: {kind: cycle, what_if: false}\n"
      "scene: {builtin: terrain, triangles: 600}\nimage: {width: 2, height: 1, samples: 1, max_depth: 1}\n"
      "camera: {eye: [0, 9, 0], target: [0, 20, 1]}\n"
      "topology: {resources: 2, visit: owners, link: {latency_cycles: 4, bytes_per_cycle: 32}}\n"
      "packets: {rays: 2, ids_per_cycle: 4}\nshading: {workers: 1, cycles_per_shade: 10}\n"
      "collections: {ready: 2, policy: fullest}\nrays: {placement: first_taker}\n",
      "machine.yaml");
  app::RenderJob job(prepared);
  ringbus::RunOptions options;
  options.trace = {0, ringbus::kNever};
  const ringbus::RunResult run =
      ringbus::run_cycle(prepared.config(), prepared.accel, prepared.scene_size(), job.workload(), options);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> placed, admitted;
  for (const ringbus::cycle::Step& step : run.cycle->steps) {
    if (step.kind == ringbus::cycle::StepKind::kPlace) placed.emplace_back(step.at, step.node);
    if (step.kind == ringbus::cycle::StepKind::kNewRays) admitted.emplace_back(step.at, step.node);
  }
  // A worker makes both rays by cycle 20. Their records need the load port of resource 0 for four cycles, up to 24, and
  // arrive in 27. Dispatch reads them in one cycle; one record is loaded by 29. The packet of 84 bytes leaves then,
  // takes the link for three cycles and has arrived in 35. The other record is loaded there by 37; the IDs leave in 37
  // and are back in 41.
  using Steps = std::vector<std::pair<std::uint64_t, std::uint32_t>>;
  EXPECT_EQ(placed, (Steps{{27, 0}, {35, 1}}));
  EXPECT_EQ(admitted, (Steps{{41, 0}}));
}

}  // namespace
}  // namespace carousel::travelling_rays_test

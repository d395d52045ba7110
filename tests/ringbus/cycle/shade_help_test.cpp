// Resources with nothing to test shade: the exact cycles of a job, notes that cross, and that it helps.
#include "ringbus/cycle/tile/stages/shade_help.h"

#include <gtest/gtest.h>

#include "ringbus/cycle/shading/shade_helpers.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

constexpr Cycle kLatency = 6, kShade = 20;

Config helping_machine() {
  Config c;
  c.engine.kind = EngineKind::kCycle;
  c.topology.link.latency_cycles = kLatency;
  c.shading.cycles_per_shade = kShade;
  c.shading.idle_resources_shade = true;
  return c;
}

struct Wires {
  LooseChannel<ShadeJob> jobs;
  LooseChannel<HelpNote> notes;
  SidePorts ports() {
    SidePorts side;
    side.jobs = &jobs;
    side.help = &notes;
    return side;
  }
};

void expect_note(Wires& wires, Cycle at, bool shaded, bool idle) {
  ASSERT_EQ(wires.notes.next(), at);
  const HelpNote note = wires.notes.take();
  EXPECT_EQ(note.shaded, shaded);
  EXPECT_EQ(note.idle, idle);
}

TEST(ShadeHelp, DoesAJobBetweenTests) {
  const Config config = helping_machine();
  Wires wires;
  ShadeHelp help(config.topology.link, wires.ports());
  help.notify(0, true);
  EXPECT_EQ(wires.notes.next(), kNever);  // all resources are idle at first
  help.notify(3, false);
  expect_note(wires, 3 + kLatency, false, false);
  help.notify(4, false);
  EXPECT_EQ(wires.notes.next(), kNever);

  wires.jobs.send(10, {kShade});
  EXPECT_EQ(help.next_job(), 10u);
  EXPECT_TRUE(help.step(10, false));  // a test is under way
  EXPECT_TRUE(help.holds());
  EXPECT_FALSE(help.shading());
  EXPECT_FALSE(help.step(12, false));
  help.notify(12, true);
  EXPECT_EQ(wires.notes.next(), kNever);  // no note while it has a job
  EXPECT_TRUE(help.step(15, true));
  EXPECT_TRUE(help.shading());
  EXPECT_EQ(help.ends(), 15 + kShade);
  EXPECT_FALSE(help.step(20, true));
  EXPECT_TRUE(help.step(15 + kShade, true));
  EXPECT_FALSE(help.holds());
  help.notify(15 + kShade, true);
  expect_note(wires, 15 + kShade + kLatency + 2, true, true);  // 68 bytes over a wire of 32
  EXPECT_EQ(help.ends(), kNever);
}

TEST(ShadeHelp, DoesNothingUnlessAsked) {
  Config config = helping_machine();
  ShadeHelp help(config.topology.link, SidePorts{});
  EXPECT_FALSE(help.step(5, true));
  help.notify(5, false);
  EXPECT_FALSE(help.holds());
  EXPECT_EQ(help.ends(), kNever);
}

RayResult ray(std::uint32_t path) {
  RayResult r;
  r.tag.path = path;
  return r;
}

TEST(ShadeHelpers, SendsOneRayToEachThatIsIdle) {
  Wires wires[3];
  const std::vector<SidePorts> sides{wires[0].ports(), wires[1].ports(), wires[2].ports()};
  ShadeHelpers helpers(sides, helping_machine().topology.link);
  HitBatch shaded;
  wires[0].notes.send(5, {false, false});
  EXPECT_EQ(helpers.next(), 5u);
  helpers.take_notes(5, shaded);
  helpers.give(ray(10), 33, 5);
  EXPECT_EQ(wires[1].jobs.next(), 5 + kLatency + 1);  // a record of 64 bytes over a wire of 32
  EXPECT_EQ(wires[1].jobs.front().cycles, 33u);
  helpers.give(ray(11), kShade, 7);
  EXPECT_EQ(wires[2].jobs.next(), 7 + kLatency + 1);
  EXPECT_FALSE(helpers.any());
  EXPECT_EQ(helpers.out(), 2u);

  // Notes that were under way when the job was sent say nothing: the one at its end does.
  wires[1].notes.send(8, {false, false});
  wires[1].notes.send(9, {false, true});
  helpers.take_notes(9, shaded);
  EXPECT_FALSE(helpers.any());
  EXPECT_TRUE(shaded.empty());
  wires[1].notes.send(40, {true, false});
  wires[2].notes.send(41, {true, true});
  helpers.take_notes(41, shaded);
  ASSERT_EQ(shaded.size(), 2u);
  EXPECT_EQ(shaded[0].tag.path, 10u);
  EXPECT_EQ(shaded[1].tag.path, 11u);
  EXPECT_EQ(helpers.out(), 0u);

  // 2 fell idle before 0.
  wires[0].notes.send(50, {false, true});
  helpers.take_notes(50, shaded);
  helpers.give(ray(12), kShade, 50);
  EXPECT_EQ(wires[2].jobs.size(), 2u);
  helpers.give(ray(13), kShade, 50);
  EXPECT_EQ(wires[0].jobs.size(), 1u);
  EXPECT_FALSE(helpers.any());
}

Outcome run_with(TestScene& scene, Config config, TopologyShape shape, bool help, std::size_t threads = 1) {
  Cell cell;
  cell.config = std::move(config);
  cell.threads = threads;
  cell.config.topology.shape = shape;
  cell.config.shading.idle_resources_shade = help;
  return run_cell(scene, cell);
}

TEST(IdleResourcesShade, LiftsAMachineThatShadingLimits) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 2000, 3);
  for (const TopologyShape shape : {TopologyShape::kRing, TopologyShape::kIndependent}) {
    Config config = helping_machine();
    config.shading.workers = 1;
    config.shading.cycles_per_shade = 200;
    const Outcome alone = run_with(scene, config, shape, false), helped = run_with(scene, config, shape, true);
    ASSERT_EQ(alone.fault + helped.fault, "");
    Cycle shading = 0;
    for (std::size_t r = 0; r < helped.result.cycle->tiles.size(); ++r) {
      const auto kShading = static_cast<std::size_t>(TileState::kShading);
      EXPECT_EQ(alone.result.cycle->tiles[r].states[kShading], 0u);
      EXPECT_EQ(helped.result.cycle->tiles[r].states[kShading] % 200, 0u);
      shading += helped.result.cycle->tiles[r].states[kShading];
    }
    // Workers and resources together shade every ray once, and the workers make the camera rays.
    EXPECT_GE(shading + helped.result.cycle->shading.busy, 200 * (scene.rays() + 2000));
    EXPECT_LT(helped.result.cycle->cycles * 2, alone.result.cycle->cycles) << enum_name(shape);
    const Outcome together = run_with(scene, config, shape, true, 3);
    ASSERT_EQ(together.fault, "");
    EXPECT_TRUE(*together.result.cycle == *helped.result.cycle) << enum_name(shape);
  }
}

TEST(Distribute, LoadIsBetterThanChance) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 2000, 3);
  const auto cycles = [&](ShadingConfig::Distribute distribute) {
    Config config = helping_machine();
    config.shading.workers = 8;
    config.shading.cycles_per_shade = 300;
    config.rays.slots_per_resource = 2;  // too few rays to keep every queue filled whatever happens
    config.shading.distribute = distribute;
    const Outcome out = run_with(scene, config, TopologyShape::kRing, false);
    EXPECT_EQ(out.fault, "");
    return out.result.cycle->cycles;
  };
  using D = ShadingConfig::Distribute;
  const Cycle fifo = cycles(D::kFifoFill), load = cycles(D::kLoad), turns = cycles(D::kRoundRobin),
              chance = cycles(D::kRandom);
  EXPECT_LT(fifo, chance);
  EXPECT_LT(load, chance);
  EXPECT_NE(turns, fifo);
  EXPECT_NE(turns, chance);
}

}  // namespace
}  // namespace carousel::ringbus::cycle

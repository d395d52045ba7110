// Random machines with random faults on either engine: whatever fails, the same hits, nothing lost, and an end.
#include <gtest/gtest.h>

#include "tests/ringbus/identity/machine_space.h"
#include "tests/ringbus/support/watchdog.h"

namespace carousel::ringbus {
namespace {

using FaultKind = FaultsConfig::Resource::Kind;

/// Fractions, times and resources that the factors do not have; the kind of the resource's fault stays.
void draw_faults(std::mt19937& random, FaultsConfig& f, const Config& c) {
  f.seed = random();
  const auto fraction = [&] { return random() % 3 == 0 ? 0.02 * (1 + random() % 6) : 0.0; };
  if (random() % 2 == 0)
    f.links = {fraction(), fraction(), fraction(),
               fraction(), fraction(), 1 + static_cast<std::int64_t>(random() % 200)};
  FaultsConfig::Resource& r = f.resource;
  const bool slow_from_the_start = c.engine.kind == EngineKind::kCycle && r.kind == FaultKind::kSlow;
  r.number = random() % static_cast<std::uint32_t>(c.topology.resources);
  r.after_rays = slow_from_the_start ? 0 : random() % 60;
  r.cycles = 1 + random() % 50'000;
  r.factor = 2 + random() % 10;
  r.silence_cycles = 1 + random() % 5'000;
}

void expect_one_digest_whatever_fails(const std::string& engine, int machines) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 150, 2);
  std::vector<Factor> factors = machine_factors();
#ifdef __SANITIZE_THREAD__
  // Libraries that are not instrumented would be reported.
  std::erase_if(factors, [](const Factor& f) {
    return f.key == "topology.link.queue" || f.key.starts_with("shading.queue") || f.key.starts_with("rays.queue");
  });
#endif
  MachineSpace space(std::move(factors));
  std::uint64_t restarts = 0, resent = 0, discarded = 0, packets_discarded = 0;
  const auto stops_seen = [&] { return restarts > 0 && packets_discarded > 0; };
  const auto link_faults_seen = [&] { return resent > 0 && discarded > 0; };
  const auto count = static_cast<std::uint32_t>(cell_count(machines));
  for (std::uint32_t i = 0; i < count || (!(stops_seen() && link_faults_seen()) && i < 20 * count + 100); ++i) {
    const std::uint32_t seed = run_seed() + i;
    std::mt19937 random(seed * 6700417);
    std::vector<std::string> with{"engine.kind=" + engine, "test.non_opaque=false", "scene.builtin=terrain"};
    if (kThreadSanitizer) with.push_back("engine.threads=2");
    if (i >= count) {  // few of all machines can show the kinds of fault that are still to be seen
      if (!stops_seen()) with.push_back("faults.resource.kind=stop");
      if (!link_faults_seen()) with.push_back("test.link_faults=true");
    }
    Cell cell = space.draw_cell(random, with);
    draw_faults(random, cell.config.faults, cell.config);
    if (!is_accepted(cell.config)) continue;
    Watchdog watchdog(std::chrono::seconds(60), cell.text());
    cell.stop = watchdog.token();
    const Outcome out = run_cell(scene, cell);
    ASSERT_EQ(out.fault, "") << "seed " << seed << ": " << cell.text();
    restarts += out.result.rays_restarted;
    packets_discarded += out.result.packets_discarded;
    for (const LinkResult& link : out.result.links) {
      resent += link.faults.resent;
      discarded += link.faults.discarded;
    }
  }
  EXPECT_GT(restarts, 0u) << "no ray was ever restarted";
  EXPECT_GT(packets_discarded, 0u) << "no packet was ever under way at a stop";
  EXPECT_GT(resent, 0u) << "no frame was ever sent again";
  EXPECT_GT(discarded, 0u) << "no frame was ever discarded";
}

TEST(RandomFaults, OnTheNativeEngine) {
  expect_one_digest_whatever_fails("native", 20);
}
TEST(RandomFaults, UnderVirtualTime) {
  if (kThreadSanitizer) GTEST_SKIP() << kOneThread;
  expect_one_digest_whatever_fails("cycle", 30);
}

}  // namespace
}  // namespace carousel::ringbus

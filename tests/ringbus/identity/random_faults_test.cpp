// Random machines with random faults on either engine: whatever fails, the same hits, nothing lost, and an end.
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

#include "tests/ringbus/identity/factors.h"

namespace carousel::ringbus {
namespace {

using Kind = FaultsConfig::Resource::Kind;

/// Ends a run that takes far too long, so that it is reported as incomplete; and the test, if that is in vain.
class Watchdog {
 public:
  Watchdog(std::chrono::seconds patience, std::string run)
      : thread_([this, patience, run = std::move(run)](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          over_.wait_for(lock, over, patience, [] { return false; });
          if (!over.stop_requested()) run_.request_stop();
          over_.wait_for(lock, over, patience / 3, [] { return false; });
          if (over.stop_requested()) return;
          std::cerr << "does not end: " << run << std::endl;
          std::abort();
        }) {}
  std::stop_token token() const { return run_.get_token(); }

 private:
  std::stop_source run_;
  std::mutex mutex_;
  std::condition_variable_any over_;
  std::jthread thread_;
};

void draw_faults(std::mt19937& random, Cell& cell) {
  Config& c = cell.config;
  FaultsConfig& f = c.faults;
  f.seed = random();
  const auto fraction = [&] { return random() % 3 == 0 ? 0.02 * (1 + random() % 6) : 0.0; };
  if (random() % 2 == 0) {
    f.links = {fraction(), fraction(), fraction(),
               fraction(), fraction(), 1 + static_cast<std::int64_t>(random() % 200)};
  }
  const std::array kinds{Kind::kNone, Kind::kPause, Kind::kSlow, Kind::kStop, Kind::kStop};
  FaultsConfig::Resource& r = f.resource;
  r.kind = kinds[random() % kinds.size()];
  if (c.topology.shape == TopologyShape::kIndependent) r.kind = Kind::kNone;
  if (c.topology.resources == 1 && r.kind == Kind::kStop) r.kind = Kind::kPause;
  const bool slow_from_the_start = c.engine.kind == EngineKind::kCycle && r.kind == Kind::kSlow;
  r.number = random() % static_cast<std::uint32_t>(c.topology.resources);
  r.after_rays = slow_from_the_start ? 0 : random() % 60;
  r.cycles = 1 + random() % 50'000;
  r.factor = 2 + random() % 10;
  r.silence_cycles = 1 + random() % 5'000;
}

struct Seen {
  std::uint64_t restarts = 0, resent = 0, discarded = 0, packets_discarded = 0;
  bool all() const { return restarts > 0 && resent > 0 && discarded > 0 && packets_discarded > 0; }
};

void expect_one_digest_whatever_fails(const std::vector<Factor>& factors, int cells) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 600, 0), 150, 2);
  Seen seen;
  const auto count = static_cast<std::uint32_t>(cell_count(cells));
  for (std::uint32_t i = 0; i < count || (!seen.all() && i < 20 * count + 100); ++i) {
    const std::uint32_t seed = run_seed() + i;
    std::mt19937 random(seed * 6700417);
    Cell cell;
    do {
      cell = Cell{};
      for (const Factor& f : factors) f.levels[random() % f.levels.size()](cell);
      if (random() % 4 == 0) cell.config.bundles.size = 4;
    } while (!possible(cell.config));
    draw_faults(random, cell);
    Watchdog watchdog(std::chrono::seconds(60), cell.text());
    cell.stop = watchdog.token();
    const Outcome out = run_cell(scene, cell);
    ASSERT_EQ(out.fault, "") << "seed " << seed << ": " << cell.text();
    seen.restarts += out.result.rays_restarted > 0;
    seen.packets_discarded += out.result.packets_discarded;
    for (const LinkResult& link : out.result.links) {
      seen.resent += link.faults.resent;
      seen.discarded += link.faults.discarded;
    }
  }
  EXPECT_GT(seen.restarts, 0u) << "no rays ever began again";
  EXPECT_GT(seen.packets_discarded, 0u) << "nothing was ever under way";
  EXPECT_GT(seen.resent, 0u) << "no frame was ever sent again";
  EXPECT_GT(seen.discarded, 0u) << "no frame ever came in vain";
}

TEST(RandomFaults, OnTheNativeEngine) {
  std::vector<Factor> factors = machine_factors();
#ifdef __SANITIZE_THREAD__
  // Libraries that are not instrumented would be reported.
  std::erase_if(factors, [](const Factor& f) { return f.name == "queue"; });
#endif
  expect_one_digest_whatever_fails(factors, 20);
}

TEST(RandomFaults, UnderVirtualTime) {
  expect_one_digest_whatever_fails(cycle_factors(), 40);
}

}  // namespace
}  // namespace carousel::ringbus

// When a collection that is not full may go (`collections.partial`).
#include <fmt/format.h>

#include "core/system/error.h"
#include "tests/app/time/timed_run.h"

namespace carousel::partial_collections_test {
namespace {

class PartialCollections : public TimedRun {
 protected:
  Json run(const std::string& machine, std::vector<std::string> sets) {
    sets.insert(sets.begin(), {"topology.resources=1", "shading.workers=16", "packets.rays=32"});
    return report("scene: {builtin: terrain, triangles: 3000}\n" + machine, sets);
  }
  static std::uint64_t cycles(const Json& report) { return report["engine"]["cycles"]; }
};

constexpr const char* kOneRay = "image: {width: 1, height: 1, samples: 1, max_depth: 1}\n";
constexpr const char* kFewRays =
    "image: {width: 16, height: 16, samples: 1, max_depth: 3}\n"
    "rays: {slots_per_resource: 64}\n";

// Few rays fill no collections, so all that can hide memory are other collections that go before they are full.
TEST_F(PartialCollections, LookAheadHidesMemoryOnlyIfTheyMayGoAhead) {
  const auto with = [&](const char* partial, int fetch_ahead) {
    return cycles(run(
        kFewRays, {fmt::format("collections.partial={}", partial), fmt::format("memory.fetch_ahead={}", fetch_ahead),
                   "memory.shape_buffer_kib=64", "memory.l2_kib=16", "memory.dram_bytes_per_cycle=1024"}));
  };
  const std::uint64_t idle = with("idle", 2);
  EXPECT_GE(with("idle", 32) * 1.1, idle);
  const std::uint64_t two = with("ahead", 2), eight = with("ahead", 8), many = with("ahead", 32);
  EXPECT_LT(two, 0.8 * idle);
  EXPECT_LT(eight, 0.8 * two);
  EXPECT_LE(many, 1.02 * eight);
}

// A ray alone waits in each of its collections for the same time, one after another.
TEST_F(PartialCollections, ACollectionWaitsAsLongAsAsked) {
  const std::vector<std::string> ordered{"collections.traversal=ordered"};
  const Json idle = run(kOneRay, {ordered[0], "collections.partial=idle"});
  const std::uint64_t packets = idle["packets"]["issued"];
  ASSERT_GT(packets, 3u);
  // Its packets may be issued while the dispatch stage still reads the ID that has come back, for a cycle.
  const std::uint64_t ahead = cycles(run(kOneRay, {ordered[0], "collections.partial=ahead"}));
  EXPECT_LE(ahead, cycles(idle));
  EXPECT_GE(ahead + packets, cycles(idle));
  std::uint64_t last = 0;
  for (const std::uint64_t wait : {100, 1000, 1100}) {
    const std::uint64_t after = cycles(run(
        kOneRay, {ordered[0], "collections.partial=after", fmt::format("collections.partial_after_cycles={}", wait)}));
    // Without the dispatch stage's time for the ID that comes back, which the wait hides.
    EXPECT_EQ(after, last == 0 ? after : last + packets * (wait == 1100 ? 100 : 900));
    EXPECT_NEAR(static_cast<double>(after), static_cast<double>(cycles(idle) + packets * wait),
                static_cast<double>(packets));
    last = after;
  }
}

TEST_F(PartialCollections, TheNativeEngineHasNoClockToWaitBy) {
  EXPECT_THROW(
      report(std::string("scene: {builtin: terrain}\n") + kOneRay, {"engine.kind=native", "collections.partial=after"}),
      ConfigError);
}

}  // namespace
}  // namespace carousel::partial_collections_test

// The prefetcher in whole machines, which are configured as users do.
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/time/timed_run.h"

namespace carousel::prefetcher_test {
namespace {

using PrefetcherInAMachine = TimedRun;

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 4000}\nimage: {width: 24, height: 16, samples: 1}\n"
    "topology: {resources: 4}\nrays: {slots_per_resource: 64}\n"
    "memory: {l2_kib: 16, shape_buffer_kib: 1, shared_by: 2, dram_latency_cycles: 400}\n";

/// A counter of the caches, all together.
std::uint64_t sum(const nlohmann::ordered_json& report, const std::string& counter) {
  std::uint64_t out = 0;
  for (const auto& cache : report["memory"]["caches"])
    out += cache.value(nlohmann::ordered_json::json_pointer("/" + counter), std::uint64_t{0});
  return out;
}

TEST_F(PrefetcherInAMachine, IsHeardAndServedAndChangesNoHit) {
  for (const char* shape : {"ring", "independent"}) {
    SCOPED_TRACE(shape);
    const std::string shape_set = std::string("topology.shape=") + shape;
    const Json without = report(kMachine, {shape_set}), with = report(kMachine, {shape_set, "prefetcher.lines=4"});
    EXPECT_EQ(with["digest"], without["digest"]);
    const Json& counts = with["prefetcher"];
    EXPECT_EQ(counts["hints"], sum(with, "requests"));  // L2s hear of each request as the prefetchers do
    EXPECT_GT(counts["lines"], 0);
    EXPECT_EQ(sum(with, "ahead/asked"), counts["lines"]);
    EXPECT_NE(with["engine"]["cycles"], without["engine"]["cycles"]);
    EXPECT_EQ(with["memory"]["dram_lines"], sum(with, "misses") + sum(with, "ahead/fetched"));
    EXPECT_EQ(bytes(with, "line requests"), 8 * with["memory"]["dram_lines"].get<std::uint64_t>());
  }
}

// A ray by itself that takes nodes in the order in which they lie, one a line.
TEST_F(PrefetcherInAMachine, ShortensTheWayOfASingleRayThroughATree) {
  const auto run = [&](const char* lines) {
    return report(kMachine, {"topology={resources: 1, shape: independent}", "rays.slots_per_resource=1",
                             "collections.order=stored", "memory.line_bytes=256",
                             std::string("prefetcher={streams: 8, reach: 16, lines: ") + lines + "}"});
  };
  const Json without = run("0"), with = run("2");
  EXPECT_GT(with["prefetcher"]["met"], 0);
  EXPECT_LT(sum(with, "misses"), sum(without, "misses"));
  EXPECT_LT(with["engine"]["cycles"], without["engine"]["cycles"]);
  EXPECT_EQ(sum(with, "lines"), sum(without, "lines"));
}

TEST_F(PrefetcherInAMachine, GoesWithOwnCachesAndAnyNumberOfThreads) {
  const std::vector<std::string> sets{"memory.l1_kib=2", "memory.l2_mshrs=4", "prefetcher.lines=2"};
  std::vector<std::string> threads = sets;
  threads.emplace_back("engine.threads=3");
  Json one = report(kMachine, sets), three = report(kMachine, threads);
  EXPECT_GT(one["prefetcher"]["lines"], 0);
  EXPECT_GT(sum(one, "ahead/dropped"), 0u);
  EXPECT_EQ(one["memory"], three["memory"]);
  EXPECT_EQ(one["prefetcher"], three["prefetcher"]);
  EXPECT_EQ(one["engine"]["cycles"], three["engine"]["cycles"]);
}

// A section with lines: 0 is no prefetcher: the report is the one without the section, and has no word of it.
TEST_F(PrefetcherInAMachine, IsNotThereUnlessItIsAskedFor) {
  Json without = report(kMachine), off = report(kMachine, {"prefetcher={lines: 0, streams: 9, reach: 7}"});
  EXPECT_EQ(off["ignored_keys"], (std::vector<std::string>{"prefetcher.reach", "prefetcher.streams"}));
  for (Json* report : {&without, &off})
    for (const char* key : {"host", "config", "ignored_keys", "checksum"}) report->erase(key);
  EXPECT_EQ(off, without);
  EXPECT_FALSE(off.contains("prefetcher"));
  EXPECT_FALSE(off["memory"]["caches"][0].contains("ahead"));
  for (const Json& row : off["bytes"])
    EXPECT_THAT(row["what"].get<std::string>(), testing::Not(testing::HasSubstr("prefetch")));
}

}  // namespace
}  // namespace carousel::prefetcher_test

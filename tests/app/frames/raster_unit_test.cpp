// The raster pass in the simulated machine (`raster.time: cycles`).
#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "report/run/report_json.h"
#include "tests/app/frames/series_program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::raster_unit_test {
namespace {

using Json = nlohmann::ordered_json;

class RasterUnit : public SeriesProgram {
 protected:
  using Sets = std::vector<std::string>;
  /// On the cycle engine, with primary: raster.
  Json pass(const std::string& scene, Sets sets) const {
    sets.insert(sets.begin(), {"engine.kind=cycle", "primary=raster", "frames.count=1"});
    return run(scene, sets);
  }
  static std::uint64_t cycles(const Json& report) { return report["raster_unit"]["cycles"]; }
  static constexpr const char* kTime = "raster.time=cycles";
};

TEST_F(RasterUnit, EachSampleIsWrittenOnceAndReadOnce) {
  for (const std::string& scene : {kBalls, kSwarm, std::string("{builtin: foliage, triangles: 300}"),
                                   std::string("{builtin: spheres, triangles: 400, procedural: true}")})
    for (const char* more : {"image.samples=1", "image.samples=3", "memory.l2_write=back", "memory.l2_kib=2",
                             "topology.shape=independent", "shading.program.default=built_in", "image.width=21"}) {
      SCOPED_TRACE(scene + " " + more);
      const Json free = pass(scene, {more}), timed = pass(scene, {more, kTime});
      EXPECT_THAT(schema_problems(report::report_schema(), timed), testing::IsEmpty());
      EXPECT_FALSE(free.contains("raster_unit"));
      EXPECT_EQ(timed["digest"], free["digest"]);
      EXPECT_EQ(timed["raster"], free["raster"]);
      const Json &unit = timed["raster_unit"], &image = timed["config"]["image"];
      const std::uint64_t samples = image["width"].get<std::uint64_t>() * image["height"].get<std::uint64_t>() *
                                    image["samples"].get<std::uint64_t>();
      EXPECT_EQ(unit["sample_bytes"], 20 * samples);
      EXPECT_EQ(unit["list_bytes"], 16 * timed["raster"]["binned"].get<std::uint64_t>());
      // Lines of 64 bytes; paths that begin together share them, and neighbours may read one again.
      const std::uint64_t read = timed["memory"]["ray_data"]["first_hits_read"];
      EXPECT_GE(read, 20 * samples);
      EXPECT_LT(read, 64 * 2 * samples);
      EXPECT_EQ(read % 64, 0u);
      EXPECT_EQ(unit["limits"], unit["cycles"].get<std::uint64_t>() > timed["engine"]["cycles"].get<std::uint64_t>());
    }
}

// Two triangles fill the picture of one tile. The unit sets both up, and each is tested at all samples whose pixels its
// box touches.
TEST_F(RasterUnit, TheTimeOfAStageFollowsItsRate) {
  const std::string scene = "{builtin: terrain, triangles: 2}";
  const Sets tile{kTime, "image.width=8", "image.height=8", "image.samples=4"};
  const auto with = [&](Sets more) {
    more.insert(more.begin(), tile.begin(), tile.end());
    return pass(scene, more);
  };
  const Json base = with({"raster.samples_per_cycle=1"});
  const std::uint64_t tested = base["raster"]["tested"], binned = base["raster"]["binned"];
  ASSERT_EQ(base["raster"]["triangles"], 2);
  ASSERT_EQ(binned, 2u);
  ASSERT_GT(tested, 100u);
  // A chunk of two triangles, and a tile whose tests take longer than its two triangles.
  EXPECT_EQ(base["raster_unit"]["busy_cycles"], 2 + tested);
  for (const std::uint64_t rate : {2, 7, 64}) {
    const Json fast = with({"raster.samples_per_cycle=" + std::to_string(rate)});
    const std::uint64_t tests = std::max<std::uint64_t>(2, (tested + rate - 1) / rate);
    EXPECT_EQ(fast["raster_unit"]["busy_cycles"], 2 + tests);
    EXPECT_EQ(cycles(fast), cycles(base) - tested + tests);
  }
  EXPECT_EQ(cycles(with({"raster.samples_per_cycle=1", "raster.latency_cycles=116"})), cycles(base) + 2 * 100)
      << "once a stage";
  EXPECT_EQ(cycles(with({"raster.samples_per_cycle=1", "raster.triangles_per_cycle=2", "raster.tiles_per_cycle=2"})),
            cycles(base) - 1);
  EXPECT_EQ(cycles(with({"raster.samples_per_cycle=1", "raster.triangles_per_cycle=2"})), cycles(base))
      << "to sort them takes as long";
  EXPECT_GT(cycles(with({"raster.samples_per_cycle=1", "raster.bytes_per_cycle=1"})), cycles(base) + 64 * 20);
  EXPECT_GT(cycles(with({"raster.samples_per_cycle=1", "raster.requests=1"})), cycles(base));
  // The vertices of the terrain are four of 32 bytes, in two lines, and its transform is none: both stages read these,
  // and the second the list. Of 256 samples 80 lines are written, and a line of the list.
  const Json& l2 = base["raster_unit"]["l2"];
  EXPECT_EQ(l2["lines"], 2 + 2 + 1);
  EXPECT_EQ(l2["written"], 1 + 80);
  EXPECT_EQ(base["raster_unit"]["bytes_written"], 64 * (1 + 80));
}

// A tile of leaves that are cut out: its any-hit calls are its longest stage.
TEST_F(RasterUnit, AnyHitCallsTakeTheirTime) {
  const auto with = [&](Sets more) {
    more.insert(more.end(), {kTime, "image.width=8", "image.height=8", "image.samples=4", "shading.workers=2",
                             "raster.triangles_per_cycle=64", "raster.samples_per_cycle=4096"});
    return pass("{builtin: foliage, triangles: 300}", more);
  };
  const auto busy = [&](Sets more) { return with(std::move(more))["raster_unit"]["busy_cycles"].get<std::uint64_t>(); };
  const Sets one{"testers.any_hit_unit={units: 1, interval_cycles: 100}"};
  const Json base = with(one);
  const std::uint64_t asked = base["raster"]["asked"];
  ASSERT_GT(asked, 20u);
  const std::uint64_t set_up = base["raster_unit"]["busy_cycles"].get<std::uint64_t>() - 100 * asked;
  EXPECT_EQ(busy({"testers.any_hit_unit={units: 1, interval_cycles: 200}"}), set_up + 200 * asked);
  EXPECT_EQ(busy({"testers.any_hit_unit={units: 3, interval_cycles: 200}"}), set_up + (200 * asked + 2) / 3);
  const auto shaders = [&](const char* lanes) {
    return busy({"testers.any_hit=shader", "shading.cycles_per_any_hit=200", lanes});
  };
  EXPECT_EQ(shaders("shading.lanes=1"), set_up + 100 * asked);
  EXPECT_EQ(shaders("shading.lanes=4"), set_up + 100 * ((asked + 3) / 4));
}

// What a sample of the frame says of the pass, which is that of the whole frame.
TEST_F(RasterUnit, OfASampleIsHeldAgainstTheEstimateOfTheFrame) {
  const auto with = [&](const char* part) {
    return pass("{builtin: spheres, triangles: 3000}",
                {kTime, "image.width=64", "image.height=48", "raster.samples_per_cycle=1", part});
  };
  const Json whole = with("sampling.fraction=1"), sample = with("sampling.fraction=0.25");
  EXPECT_EQ(cycles(sample), cycles(whole));
  ASSERT_GT(cycles(sample), sample["engine"]["cycles"].get<std::uint64_t>());
  ASSERT_LT(static_cast<double>(cycles(sample)), sample["sampled"]["cycles"]["estimate"].get<double>());
  EXPECT_EQ(sample["raster_unit"]["limits"], false);
  EXPECT_EQ(whole["raster_unit"]["limits"], false);
}

TEST_F(RasterUnit, RaysFindInTheCacheWhatThePassLeftThere) {
  const auto reads = [&](const char* kib) {
    const Json r = pass(kBalls, {kTime, "memory.l2_write=back", std::string("memory.l2_kib=") + kib});
    return r["memory"]["dram_lines"].get<std::uint64_t>();
  };
  EXPECT_LT(reads("1024"), reads("2"));
  const Json timed = pass(kBalls, {kTime, "shading.workers=1"}), free = pass(kBalls, {"shading.workers=1"});
  EXPECT_GT(timed["engine"]["cycles"], free["engine"]["cycles"]) << "a worker waits for its samples";
}

TEST_F(RasterUnit, EachFrameHasItsPass) {
  const Json report = run(kSwarm, {"engine.kind=cycle", "primary=raster", kTime, "frames.count=3", "frames.step=0.3",
                                   "energy.profile=n45"});
  std::uint64_t sum = 0;
  for (const Json& row : report["frames"]["rows"]) {
    EXPECT_GT(row["raster_cycles"], 0);
    sum += row["cycles"].get<std::uint64_t>() + row["raster_cycles"].get<std::uint64_t>();
    if (row.contains("builder")) sum += row["builder"]["cycles"].get<std::uint64_t>();
  }
  EXPECT_EQ(report["frames"]["cycles"], sum);
  EXPECT_GT(report["raster_unit"]["joules"].get<double>(), 0);
  EXPECT_GT(report["area"]["parts"]["raster_unit"]["mm2"].get<double>(), 0);
  EXPECT_EQ(report["area"]["parts"]["raster_unit"]["size"], 16) << "256 lines of 64 bytes";
}

TEST_F(RasterUnit, IsChargedAndNamedWhereItIsOfNoUse) {
  const auto lists = [](const Json& report) {
    return std::ranges::any_of(report["charges"], [](const Json& charge) { return charge["name"] == "raster"; });
  };
  EXPECT_TRUE(lists(pass(kBalls, {})));
  EXPECT_FALSE(lists(pass(kBalls, {kTime})));
  EXPECT_FALSE(lists(run(kBalls, {"engine.kind=cycle", "frames.count=1"})));
  const Json rays = run(kBalls, {"engine.kind=cycle", kTime, "frames.count=1"});
  EXPECT_THAT(rays["ignored_keys"].get<Sets>(), testing::Contains("raster.time"));
  EXPECT_THAT(pass(kBalls, {"raster.requests=8"})["ignored_keys"].get<Sets>(), testing::Contains("raster.requests"));
  refused(kBalls, {"engine.kind=native", "primary=raster", kTime}, "raster.time");
  refused(
      kBalls,
      {"engine.kind=cycle", "primary=raster", kTime,
       "topology={shape: graph, trace: stacks, nodes: [{name: r, count: 2}, {name: c, kind: cache, serves: 'r[*]'}], "
       "links: [{line: 'r[0], r[1], c', both: true, carries: [shapes]}]}"},
      "caches that are drawn do not have this yet; expected free, found cycles");
}

}  // namespace
}  // namespace carousel::raster_unit_test

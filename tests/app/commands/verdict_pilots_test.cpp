// When a pilot is like enough to the run, tried as a user would: machines drawn by `script/verdicts`, whose pilots
// differ.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"
#include "tests/app/support/run_report.h"

namespace carousel::verdict_pilots_test {
namespace {

using Json = nlohmann::ordered_json;

class VerdictPilots : public testing::Test {
 protected:
  Json searched(const std::string& config) const { return run_report(program_, config, {"engine.what_if=true"}); }

  /// Runs the relaxed machine of a gain in the configuration of the last search: the real gain lies in its interval.
  void expect_real(const Json& report, const Json& gain) const {
    std::vector<std::string> words{"run", "a.yaml", "--quiet", "--force", "--out", "twice"};
    for (const Json& set : gain["sets"]) words.insert(words.end(), {"--set", set.get<std::string>()});
    ASSERT_EQ(program_.run(words).status, 0);
    const Json twice = Json::parse(program_.read("twice/report.json"));
    const double real = report["engine"]["cycles"].get<double>() / twice["engine"]["cycles"].get<double>() - 1;
    EXPECT_GE(real, gain["low"].get<double>()) << gain.dump();
    EXPECT_LE(real, gain["high"].get<double>()) << gain.dump();
  }

  const Program program_;
};

constexpr const char* kOwnCaches =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 40, height: 28, samples: 2, max_depth: 5}\n"
    "scene: {builtin: spheres, triangles: 4000}\n"
    "topology: {resources: 8, shape: independent, visit: owners, link: {latency_cycles: 16, bytes_per_cycle: 16, "
    "depth: 16}}\n"
    "packets: {ids_per_cycle: 32}\n"
    "collections: {traversal: spread}\n"
    "rays: {slots_per_resource: 32}\n"
    "testers: {box: {units: 1}, triangle: {units: 4, interval_cycles: 1}, contexts: 2}\n"
    "memory: {l2_latency_cycles: 10, dram_latency_cycles: 400, dram_bytes_per_cycle: 4, l2_kib: 8, l1_kib: 64, "
    "shape_buffer_kib: 4}\n"
    "shading: {workers: 1, cycles_per_shade: 4}\n";

constexpr const char* kOtherCycles =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 48, height: 32, samples: 2, max_depth: 2}\n"
    "scene: {builtin: terrain, triangles: 4000}\n"
    "topology: {resources: 8, shape: bus, visit: owners, link: {latency_cycles: 1, bytes_per_cycle: 4, depth: 16}}\n"
    "packets: {ids_per_cycle: 32}\n"
    "collections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 64}\n"
    "rays: {slots_per_resource: 16}\n"
    "testers: {box: {units: 4}, triangle: {units: 4, interval_cycles: 4}, contexts: 2}\n"
    "memory: {l2_latency_cycles: 10, dram_latency_cycles: 400, dram_bytes_per_cycle: 4, l2_kib: 64, shape_buffer_kib: "
    "64}\n"
    "shading: {workers: 16, cycles_per_shade: 4}\n";

constexpr const char* kTerrainBelow =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 80, height: 56, samples: 2, max_depth: 3}\n"
    "scene: {builtin: terrain, triangles: 4000}\n"
    "topology: {resources: 4, shape: bidirectional, visit: all, link: {latency_cycles: 16, bytes_per_cycle: 4, depth: "
    "8}}\n"
    "packets: {ids_per_cycle: 2}\n"
    "collections: {traversal: spread}\n"
    "rays: {slots_per_resource: 64}\n"
    "testers: {box: {units: 1}, triangle: {units: 4, interval_cycles: 16}, contexts: 1}\n"
    "memory: {l2_latency_cycles: 100, dram_latency_cycles: 400, dram_bytes_per_cycle: 32, l2_kib: 64, "
    "shape_buffer_kib: 16}\n"
    "shading: {workers: 16, cycles_per_shade: 4}\n";

constexpr const char* kSlowMemory =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 80, height: 56, samples: 2, max_depth: 3}\n"
    "scene: {builtin: terrain, triangles: 40000}\n"
    "topology: {resources: 4, shape: point_to_point, visit: owners, link: {latency_cycles: 1, bytes_per_cycle: 16, "
    "depth: 8}}\n"
    "packets: {ids_per_cycle: 8}\n"
    "collections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 64}\n"
    "rays: {slots_per_resource: 16}\n"
    "testers: {box: {units: 16}, triangle: {units: 1, interval_cycles: 1}, contexts: 2}\n"
    "memory: {l2_latency_cycles: 100, dram_latency_cycles: 400, dram_bytes_per_cycle: 4, l2_kib: 512, "
    "shape_buffer_kib: 64}\n"
    "shading: {workers: 4, cycles_per_shade: 4}\n";

// Each resource needs 104 KiB of shapes again and again, and has room for 64.
constexpr const char* kNarrowBuffers =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 80, height: 56, samples: 2, max_depth: 3}\n"
    "scene: {builtin: sliver, triangles: 2000}\n"
    "topology: {resources: 8, shape: independent, visit: all, link: {latency_cycles: 16, bytes_per_cycle: 64, depth: "
    "8}}\n"
    "packets: {ids_per_cycle: 8}\n"
    "collections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 64}\n"
    "rays: {slots_per_resource: 32}\n"
    "testers: {box: {units: 16}, triangle: {units: 4, interval_cycles: 4}, contexts: 4}\n"
    "memory: {l2_latency_cycles: 100, dram_latency_cycles: 50, dram_bytes_per_cycle: 4, l2_kib: 8, shape_buffer_kib: "
    "64}\n"
    "shading: {workers: 16, cycles_per_shade: 20}\n";

constexpr const char* kBusyWorker =
    "engine: {kind: cycle, threads: 1}\n"
    "image: {width: 80, height: 56, samples: 2, max_depth: 3}\n"
    "scene: {builtin: terrain, triangles: 40000}\n"
    "topology: {resources: 4, shape: bidirectional, visit: owners, link: {latency_cycles: 1, bytes_per_cycle: 16, "
    "depth: 8}}\n"
    "packets: {ids_per_cycle: 8}\n"
    "collections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 64}\n"
    "rays: {slots_per_resource: 32}\n"
    "testers: {box: {units: 4}, triangle: {units: 1, interval_cycles: 1}, contexts: 2}\n"
    "memory: {l2_latency_cycles: 100, dram_latency_cycles: 50, dram_bytes_per_cycle: 32, l2_kib: 512, "
    "shape_buffer_kib: 4}\n"
    "shading: {workers: 1, cycles_per_shade: 60}\n";

constexpr const char* kOneContext =
    "engine: {kind: cycle}\n"
    "image: {width: 80, height: 56, samples: 2, max_depth: 2}\n"
    "scene: {builtin: cornell}\n"
    "topology: {resources: 4, shape: ring, visit: owners, link: {latency_cycles: 4, bytes_per_cycle: 64, depth: 8}}\n"
    "packets: {ids_per_cycle: 32}\n"
    "collections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 64}\n"
    "rays: {slots_per_resource: 32}\n"
    "testers: {box: {units: 16}, triangle: {units: 4, interval_cycles: 16}, contexts: 1}\n"
    "memory: {l2_latency_cycles: 100, dram_latency_cycles: 400, l2_kib: 64, shape_buffer_kib: 4, dram: {preset: "
    "gddr6_14, channels: 4}}\n"
    "shading: {workers: 4, cycles_per_shade: 60}\n";

// A pilot whose buffers were empty would spend its time on filling them, and more room would gain 3 % of 366.
TEST_F(VerdictPilots, MoreRoomForShapesGainsWhatTheFrameGains) {
  const Json report = searched(kNarrowBuffers), bottleneck = report["bottleneck"];
  EXPECT_EQ(bottleneck["limits"], "shape_buffer") << bottleneck.dump(1);
  EXPECT_GT(bottleneck["gains"][0]["low"], 0.9);
  expect_real(report, bottleneck["gains"][0]);
}

// The one shader worker is busy for 87 % of the time, so that nothing else gains more than 15 %, nor three points for
// the schedule. Pilots alone would allow twice that.
TEST_F(VerdictPilots, NothingGainsMoreThanTheWorkOfOthersLeaves) {
  const Json report = searched(kBusyWorker);
  ASSERT_FALSE(report["bottleneck"]["gains"].empty()) << report["bottleneck"].dump(1);
  for (const Json& gain : report["bottleneck"]["gains"])
    if (gain["name"] != "shading") {
      EXPECT_LT(gain["high"], 0.19) << gain.dump();
    }
}

// The pilot of so small a frame is half as long again as the run, and would be told to be unlike it. The frame's own
// beginning is not.
TEST_F(VerdictPilots, TheFramesBeginningNeedsNoPilotThatIsLikeTheRun) {
  const Json report = searched(kOtherCycles), bottleneck = report["bottleneck"];
  EXPECT_GT(std::abs(bottleneck["deviation"].get<double>()), 0.4);
  EXPECT_EQ(bottleneck["unlike"], "");
  EXPECT_EQ(bottleneck["limits"], "link_bandwidth") << bottleneck.dump(1);
  const Json& named = bottleneck["gains"][0];
  EXPECT_GT(named["frame"], 0.1);
  EXPECT_LT(named["frame"], 1);
  expect_real(report, named);
}

// Sky above and ground below: a draw by position alone has some percent more rays a path than the frame, and its
// cycles are a sixth off, by which nothing was found out before. The foretold gain is that of the frame.
TEST_F(VerdictPilots, PlacesAreDrawnWhoseWorkIsThatOfTheFrame) {
  const Json report = searched(kTerrainBelow), bottleneck = report["bottleneck"];
  EXPECT_EQ(bottleneck["unlike"], "");
  ASSERT_EQ(bottleneck["limits"], "contexts") << bottleneck.dump(1);
  const double rays = report["rays"]["completed"].get<double>();
  EXPECT_LT(bottleneck["rays"], 0.2 * rays);
  const Json& named = bottleneck["gains"][0];
  expect_real(report, named);
}

// The run takes a seventh less than foretold by the pilot that is taken. Contexts stand out all the same. What the
// pilot alone tells is uncertain by three quarters of that difference, of half of the time.
TEST_F(VerdictPilots, AClassThatStandsOutIsNamedInSpiteOfOtherCycles) {
  const Json report = searched(kSlowMemory), bottleneck = report["bottleneck"];
  EXPECT_EQ(bottleneck["unlike"], "");
  EXPECT_EQ(bottleneck["limits"], "contexts") << bottleneck.dump(1);
  const double off = std::abs(bottleneck["deviation"].get<double>());
  EXPECT_GT(off, 0.1);
  int of_pilot = 0;
  for (const Json& one : bottleneck["gains"]) {
    if (one["together"] != 1 || one["frame"] > 0) continue;
    ++of_pilot;
    const double gain = one["gain"], half = gain - one["low"].get<double>();
    EXPECT_GE(half, 0.75 * off * (1 + gain) * (1 + gain) / 2 - 1e-6) << one.dump();
  }
  EXPECT_GE(of_pilot, 2);
  EXPECT_LT(bottleneck["rays"], 0.1 * report["rays"]["completed"].get<double>());
}

// A small frame of which most is in the resources' own caches: pilots in which these were cold foretold a quarter fewer
// cycles than it took, and nothing was found out.
TEST_F(VerdictPilots, OwnCachesBeginWithWhatTheRunsHeld) {
  const Json report = searched(kOwnCaches), bottleneck = report["bottleneck"];
  EXPECT_EQ(bottleneck["unlike"], "");
  EXPECT_EQ(bottleneck["limits"], "memory_bandwidth") << bottleneck.dump(1);
  EXPECT_EQ(report["bound"]["classes"][0]["name"], "memory_bandwidth");
}

// The pilot leaves two classes that may be the best. The frame is simulated for them on several threads at once, in
// parts, and says the same as on one.
TEST_F(VerdictPilots, TheFrameIsSimulatedFurtherForWhatMayBeTheBestOnAnyThreads) {
  const Json report = searched(kOneContext), found = report["bottleneck"];
  EXPECT_EQ(found["limits"], "contexts") << found.dump(1);
  int raced = 0;
  for (const Json& gain : found["gains"]) raced += gain.value("frame", 0.0) > 0 && gain.value("frame", 0.0) < 1;
  EXPECT_GE(raced, 2) << found.dump(1);
  expect_real(report, found["gains"][0]);
  for (const char* threads : {"1", "3"}) {
    const std::string sets = std::string("engine.threads=") + threads;
    EXPECT_EQ(run_report(program_, kOneContext, {"engine.what_if=true", sets})["bottleneck"], found) << threads;
  }
}

}  // namespace
}  // namespace carousel::verdict_pilots_test

// The life of one ray: its spans are its latency without a gap, on any machine and with both engines, it agrees with
// the hit that shading got, and following changes nothing.
#include "ringbus/results/ray_life.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/run/following_workload.h"
#include "app/run/render_job.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/native/native_engine.h"

namespace carousel::app {
namespace {

using ringbus::LifeSpan;
using ringbus::LifeStage;
using ringbus::RayLife;

struct Followed {
  std::optional<RayLife> life;
  std::optional<RayResult> result;
  std::vector<RayTag> caused;
  std::optional<RayTag> last_of_path;
  ringbus::RunResult run;
  std::string hits, unfollowed_hits;
  std::uint64_t unfollowed_cycles = 0;
};

Followed follow(const std::string& config, const RayPlace& place) {
  const Prepared p = prepare_config(config, "test");
  Followed out;
  const bool cycle = p.config().engine.kind == EngineKind::kCycle;
  const auto run = cycle ? ringbus::run_cycle : ringbus::run_native;
  ringbus::RunOptions options;
  options.threads = p.threads;
  {
    RenderJob job(p);
    const ringbus::RunResult plain = run(p.config(), p.accel, p.scene_size(), job.workload(), options);
    out.unfollowed_cycles = plain.cycle ? plain.cycle->cycles : 0;
    out.unfollowed_hits = job.hits_digest();
  }
  RenderJob job(p);
  ringbus::FollowedRay ray;
  FollowingWorkload workload(
      job.workload(), place, [&](std::uint32_t path) { return job.place_of(path); }, ray);
  options.ray = &ray;
  out.run = run(p.config(), p.accel, p.scene_size(), workload, options);
  out.hits = job.hits_digest();
  if (!cycle) workload.add_times(out.run.start, out.run.facts);
  out.life = ringbus::ray_life(out.run.facts, *out.run.timeline, p.accel);
  out.result = workload.result();
  out.caused = workload.caused();
  out.last_of_path = workload.last_of_path();
  return out;
}

/// The spans have no gap and add up to the latency.
void expect_whole(const RayLife& life) {
  ASSERT_FALSE(life.spans.empty());
  std::uint64_t now = life.begin, sum = 0;
  for (const LifeSpan& span : life.spans) {
    EXPECT_EQ(span.begin, now);
    EXPECT_LT(span.begin, span.end);
    EXPECT_NE(span.stage, LifeStage::kOther) << "at " << span.begin << " for " << span.end - span.begin;
    now = span.end;
    sum += span.end - span.begin;
  }
  EXPECT_EQ(now, life.end);
  EXPECT_EQ(sum, life.end - life.begin);
}

std::map<LifeStage, std::uint64_t> sums_of(const RayLife& life) {
  std::map<LifeStage, std::uint64_t> sums;
  for (const LifeSpan& span : life.spans) sums[span.stage] += span.end - span.begin;
  return sums;
}

const char* const kFrame =
    "scene: {builtin: cornell}\nimage: {width: 12, height: 8, samples: 2}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\nrays: {slots_per_resource: 48}\n";

std::string frame(const std::string& rest) {
  return kFrame + rest;
}

TEST(RayLife, IsItsLatencyOnAnyMachine) {
  const std::vector<std::string> machines{
      "topology: {resources: 3}\n",
      "topology: {resources: 4, visit: all}\ncollections: {traversal: spread}\n",
      "topology: {resources: 3}\ncollections: {traversal: treelet}\nbvh: {treelet_triangles: 16}\n",
      "topology: {resources: 4, shape: bidirectional}\ntesters: {contexts: 1}\n",
      "topology: {resources: 4, shape: hierarchical, groups: 2}\n",
      "topology: {resources: 3, shape: bus}\n",
      "topology: {resources: 4}\ncollections: {home: hash, when_full: spill, capacity: 128}\n",
      "topology: {resources: 2}\ncollections: {home: local}\n",
      "topology: {resources: 2, shape: independent}\n",
      "topology: {resources: 3}\nmemory: {fetch: resource}\n",
      "topology: {resources: 3}\ncollections: {traversal: ordered, key: block}\n",
      "topology: {resources: 1}\n",
  };
  for (const std::string& machine : machines) {
    for (const RayPlace& place : {RayPlace{40, 1, RayKind::kCamera, 0, 0}, RayPlace{52, 0, RayKind::kBounce, 1, 0},
                                  RayPlace{52, 0, RayKind::kShadow, 0, 0}}) {
      SCOPED_TRACE(machine + std::to_string(place.pixel) + " " + std::to_string(static_cast<int>(place.kind)));
      const Followed f = follow(frame(machine), place);
      EXPECT_EQ(f.run.cycle->cycles, f.unfollowed_cycles);
      EXPECT_EQ(f.hits, f.unfollowed_hits);
      ASSERT_TRUE(f.life);
      expect_whole(*f.life);
      EXPECT_TRUE(f.life->complete);
      EXPECT_FALSE(f.life->tests.empty());
      EXPECT_LE(f.life->end, f.run.cycle->cycles);
      ASSERT_TRUE(f.result);
      EXPECT_EQ(f.life->hit.t, f.result->hit.t);
      EXPECT_EQ(f.life->hit.primitive, f.result->hit.primitive);
      auto sums = sums_of(*f.life);
      EXPECT_GT(sums[LifeStage::kTest], 0u);
      EXPECT_GT(sums[LifeStage::kLoad], 0u);
      EXPECT_GT(sums[LifeStage::kReturn], 0u);
      if (place.kind == RayKind::kShadow) {
        EXPECT_TRUE(f.caused.empty());  // there are no panes
      }
      for (const RayTag& child : f.caused)
        EXPECT_EQ(child.bounce, child.kind == RayKind::kShadow ? place.bounce : place.bounce + 1);
    }
  }
}

// A ray of a warp waits in its resource for the slowest of them, between its tests and behind the last.
TEST(RayLife, OfAWarpWaitsForTheOthersInItsResource) {
  const Followed f =
      follow(frame("topology: {resources: 2, shape: independent}\ntesters: {simt: {warp: 16, warps: 3}}\n"),
             RayPlace{40, 1, RayKind::kCamera, 0, 0});
  ASSERT_TRUE(f.life && f.life->resource);
  std::uint64_t now = f.life->begin, waits = 0;
  for (const LifeSpan& span : f.life->spans) {
    EXPECT_EQ(span.begin, now);
    now = span.end;
    if (span.stage != LifeStage::kOther) continue;
    waits += span.end - span.begin;
    EXPECT_EQ(span.part, "resource " + std::to_string(*f.life->resource));
  }
  EXPECT_EQ(now, f.life->end);
  EXPECT_GT(waits, 0u);
}

// A packet of a block of memory names none of the nodes that its rays are at.
TEST(RayLife, HasTheRaysOwnNodesOfABlock) {
  std::size_t tests = 0;
  for (const RayPlace& place : {RayPlace{40, 1, RayKind::kCamera, 0, 0}, RayPlace{52, 0, RayKind::kBounce, 1, 0}}) {
    const auto life = [&](const char* collections) {
      return follow(
                 frame("topology: {resources: 3}\ncollections: {traversal: ordered" + std::string(collections) + "}\n"),
                 place)
          .life;
    };
    const auto by_node = life(""), by_block = life(", key: block, block_bytes: 8192");
    ASSERT_TRUE(by_node && by_block);
    ASSERT_EQ(by_block->tests.size(), by_node->tests.size());
    for (std::size_t i = 0; i < by_node->tests.size(); ++i) {
      EXPECT_EQ(by_block->tests[i].key, by_node->tests[i].key);
      EXPECT_EQ(by_block->tests[i].depth, by_node->tests[i].depth);
    }
    tests += by_node->tests.size();
  }
  EXPECT_GT(tests, 4u);
}

// The ray that is the child of another is made in the cycle in which its parent has been shaded.
TEST(RayLife, ARayBeginsWhenItsParentEnds) {
  const std::string config = frame("topology: {resources: 3}\n");
  const Followed parent = follow(config, {52, 0, RayKind::kCamera, 0, 0});
  ASSERT_FALSE(parent.caused.empty());
  for (const RayTag& child : parent.caused) {
    const Followed f = follow(config, {52, 0, child.kind, child.bounce, 0});
    ASSERT_TRUE(f.life);
    EXPECT_EQ(f.life->begin, parent.life->end);
  }
}

// One ray alone that misses the scene: made, loaded, tested once with the children of the root, and shaded. Each number
// follows from docs/internals/cycle-engine-exact.md.
TEST(RayLife, OfALoneRayIsWhatHandsCompute) {
  const std::string config =
      "scene: {builtin: cornell}\nimage: {width: 1, height: 1, samples: 1, max_depth: 1}\n"
      "camera: {aperture: 0}\nengine: {kind: cycle, threads: 1, what_if: false}\n"
      "topology: {resources: 1, link: {latency_cycles: 6, bytes_per_cycle: 16}}\n"
      "shading: {workers: 1, cycles_per_shade: 40, effects: []}\n"
      "memory: {l2_latency_cycles: 30, dram_latency_cycles: 200, dram_bytes_per_cycle: 64, line_bytes: 64}\n";
  const Followed f = follow(config, {0, 0, RayKind::kCamera, 0, 0});
  ASSERT_TRUE(f.life);
  expect_whole(*f.life);
  auto sums = sums_of(*f.life);
  // A worker makes one ray, from cycle 0 on.
  EXPECT_EQ(f.life->begin, 40u);
  // 64 bytes over a port of 16 a cycle, and an ID of 4 bytes that takes one cycle of the wire and its latency.
  EXPECT_EQ(sums[LifeStage::kLoad], 4u + 6u);
  // 64 bytes over the port for completed rays, and the wire's latency.
  EXPECT_EQ(sums[LifeStage::kReturn], 4u + 6u);
  EXPECT_EQ(sums[LifeStage::kShadeQueue], 0u);
  EXPECT_EQ(sums[LifeStage::kShading], 40u);
  // Dispatch reads one ID of each packet, a cycle each; nothing is in the way of the one ray.
  EXPECT_EQ(sums[LifeStage::kDispatch], f.life->packets);
  EXPECT_EQ(sums[LifeStage::kCollection], 0u);
  EXPECT_EQ(sums[LifeStage::kSlot] + sums[LifeStage::kAdmission] + sums[LifeStage::kLink], 0u);
  EXPECT_EQ(f.life->hops, 0u);
  EXPECT_EQ(f.life->tests.size(), f.life->packets);
}

TEST(RayLife, OfTheNativeEngineIsItsLatencyToo) {
  for (const RayPlace& place : {RayPlace{40, 1, RayKind::kCamera, 0, 0}, RayPlace{52, 0, RayKind::kBounce, 1, 0}}) {
    const Followed f = follow(frame("topology: {resources: 3}\n"), place);
    Followed native = follow(
        "scene: {builtin: cornell}\nimage: {width: 12, height: 8, samples: 2}\nengine: {threads: 2}\n"
        "topology: {resources: 3}\nrays: {slots_per_resource: 48}\n",
        place);
    ASSERT_TRUE(native.life);
    EXPECT_EQ(native.hits, f.hits);
    expect_whole(*native.life);
    EXPECT_FALSE(native.life->tests.empty());
    ASSERT_TRUE(native.result);
    EXPECT_EQ(native.result->hit.t, f.result->hit.t);
    EXPECT_EQ(native.caused.size(), f.caused.size());
  }
}

TEST(RayLife, SaysWhereAPathEnded) {
  bool ended = false;
  for (std::uint32_t pixel = 0; pixel < 96 && !ended; pixel += 5) {
    const Followed f = follow(frame("topology: {resources: 2}\n"), {pixel, 0, RayKind::kBounce, 3, 0});
    ended = !f.life;
    if (!ended) continue;
    EXPECT_TRUE(f.run.facts.empty());
    ASSERT_TRUE(f.last_of_path);
    EXPECT_LT(f.last_of_path->bounce, 3);
  }
  EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace carousel::app

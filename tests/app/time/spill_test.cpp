// With `collections.when_full: spill`, entries beyond the capacity go to memory and back.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::spill_test {
namespace {

class Spill : public TimedRun {
 protected:
  Json run(int capacity, std::vector<std::string> sets = {}) {
    sets.push_back(fmt::format("collections.capacity={}", capacity));
    return report(
        "scene: {builtin: terrain, triangles: 600}\n"
        "image: {width: 12, height: 10, samples: 1, max_depth: 3}\n"
        "topology: {resources: 2}\n"
        "packets: {rays: 16}\n"
        "collections: {ready: 16, when_full: spill}\n"
        "shading: {workers: 8}\n"
        "rays: {slots_per_resource: 64}\n",
        sets);
  }
  static std::uint64_t cycles(const Json& report) { return report["engine"]["cycles"]; }
};

TEST_F(Spill, CostsTheBytesOfItsEntriesBothWaysAndTheTime) {
  for (const char* traversal : {"spread", "ordered"}) {
    SCOPED_TRACE(traversal);
    const std::string how = fmt::format("collections.traversal={}", traversal);
    const Json ample = run(65536, {how}), tight = run(16, {how});
    EXPECT_EQ(ample["collections"]["spilled"], 0);
    EXPECT_EQ(ample["collections"]["spill_bytes_written"], 0);
    EXPECT_EQ(ample["memory"]["dram_lines_written"], 0);
    const std::uint64_t ids = tight["collections"]["spilled"], written = tight["collections"]["spill_bytes_written"],
                        read = tight["collections"]["spill_bytes_read"];
    EXPECT_GT(ids, 0u);
    // 4 bytes an ID, and 12 of key and entry a move: there are as many IDs both ways, in at least as many moves there.
    EXPECT_GT(read, 4 * ids);
    EXPECT_EQ((read - 4 * ids) % 12, 0u);
    EXPECT_EQ((written - 4 * ids) % 12, 0u);
    EXPECT_GE(written, read);
    EXPECT_LE(read, 16 * ids);
    EXPECT_GE(tight["memory"]["dram_lines_written"].get<std::uint64_t>() * 64, written / 2);
    EXPECT_GT(cycles(tight), cycles(ample));
    EXPECT_EQ(tight["digest"], ample["digest"]);
    EXPECT_EQ(run(16, {how, "engine.threads=2"})["engine"]["cycles"], cycles(tight));
  }
}

// Every ray's one collection is the root's, which is in memory: its packet waits for the entries.
TEST_F(Spill, APacketWaitsForItsEntries) {
  const std::vector<std::string> one{"collections.traversal=treelet",
                                     "bvh.treelet_triangles=65536",
                                     "image.width=1",
                                     "image.height=1",
                                     "image.max_depth=1",
                                     "topology.resources=1"};
  const auto with = [&](int capacity, int latency) {
    std::vector<std::string> sets = one;
    sets.push_back(fmt::format("memory.dram_latency_cycles={}", latency));
    return run(capacity, sets);
  };
  const Json near = with(1, 1000), far = with(1, 3000);
  EXPECT_EQ(near["collections"]["spilled"], near["rays"]["completed"]);
  EXPECT_EQ(near["collections"]["spill_bytes_read"], 16 * near["rays"]["completed"].get<std::uint64_t>());
  EXPECT_EQ(near["collections"]["spill_bytes_written"], near["collections"]["spill_bytes_read"]);
  const std::uint64_t rays = near["rays"]["completed"];
  ASSERT_EQ(rays, 2u);
  const std::uint64_t least = 2000 * rays;
  EXPECT_GE(cycles(far) - cycles(near), least);
  // The first ray's entries come beside its shapes. The second ray finds its shapes in the buffer, and its entries,
  // which take the places of the first, in the L2 of 30 cycles and one of its port.
  EXPECT_GE(cycles(far), cycles(with(65536, 3000)) + 31);
}

// With testers.stack_entries the older entries of stacks of rays that go by themselves are in memory. A request has 16
// bytes, and those that it writes.
TEST_F(Spill, ShortStacksCostTheirBytesAndTheTime) {
  const auto sum = [](const Json& report, const char* key) {
    std::uint64_t out = 0;
    for (const Json& resource : report["resources"]) out += resource["stack"][key].get<std::uint64_t>();
    return out;
  };
  for (const std::string& shape :
       {std::string("topology.shape=independent"),
        std::string("topology={shape: graph, trace: stacks, nodes: [{name: r, count: 2}], links: []}")}) {
    SCOPED_TRACE(shape);
    const std::vector<std::string> machine{shape, "collections={}", "memory.shape_buffer_kib=4"};
    const auto with = [&](const std::string& more) {
      std::vector<std::string> sets = machine;
      sets.push_back(more);
      return run(65536, sets);
    };
    const Json ample = with("testers.stack_entries=0"), tight = with("testers.stack_entries=2"),
               wide = with("testers.stack_entries=256");
    EXPECT_EQ(sum(ample, "spilled_bytes"), 0u);
    EXPECT_EQ(cycles(wide), cycles(ample));
    const std::uint64_t spilled = sum(tight, "spilled_bytes"), refilled = sum(tight, "refilled_bytes");
    EXPECT_GT(refilled, 0u);
    EXPECT_GE(spilled, refilled);
    EXPECT_EQ(sum(tight, "pushed_bytes"), sum(ample, "pushed_bytes"));
    const Json row = ledger_row(tight, "shape requests");
    EXPECT_EQ(row["bytes"].get<std::uint64_t>(), 16 * row["messages"].get<std::uint64_t>() + spilled);
    EXPECT_GT(tight["memory"]["dram_lines_written"], 0);
    EXPECT_GT(cycles(tight), cycles(ample));
    EXPECT_GT(sum(with("testers.stack_entries=1"), "spilled_bytes"), spilled);
    EXPECT_EQ(tight["digest"], ample["digest"]);
    EXPECT_EQ(tight["tests"], ample["tests"]);
    EXPECT_EQ(cycles(run(65536, {shape, "collections={}", "memory.shape_buffer_kib=4", "testers.stack_entries=2",
                                 "engine.threads=2"})),
              cycles(tight));
  }
  const Json ring = run(65536, {"testers.stack_entries=2"});
  EXPECT_EQ(ring["ignored_keys"], (std::vector<std::string>{"testers.stack_entries"}));
}

}  // namespace
}  // namespace carousel::spill_test

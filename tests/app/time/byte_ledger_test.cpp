// The ledger of bytes against counts that come from elsewhere: from packets, hops, caches and rays. Checked builds
// moreover compare the bytes that were sent with those that were received, in every run of every test.
#include <fmt/format.h>

#include "ringbus/cycle/messages/side_wire.h"
#include "tests/app/keys/base_machines.h"
#include "tests/app/time/timed_run.h"

namespace carousel::byte_ledger_test {
namespace {

class ByteLedger : public TimedRun {
 protected:
  static std::uint64_t messages(const Json& report, const std::string& what) {
    return ledger_row(report, what)["messages"];
  }
};

const char* const kMachine =
    "scene: {builtin: instances, instances: 40}\nimage: {width: 24, height: 16, samples: 1}\n"
    "topology: {resources: 4}\nrays: {slots_per_resource: 64}\n";

// With ordered traversal a packet has 16 bytes, and 4 for the ID and 12 for the next node of each ray. Where all
// resources are visited it crosses every link.
TEST_F(ByteLedger, LinksCarryWhatThePacketsHold) {
  for (const char* shape : {"ring", "bidirectional", "multi_ring"}) {
    const Json r = report(
        kMachine, {"collections.traversal=ordered", fmt::format("topology.shape={}", shape), "topology.visit=all"});
    const std::uint64_t issued = r["packets"]["issued"], hops = r["packets"]["hops"];
    const auto rays = static_cast<std::uint64_t>(r["packets"]["rays_mean"].get<double>() * double(issued) + 0.5);
    ASSERT_EQ(hops, 4 * issued);
    EXPECT_EQ(bytes(r, "packets"), 16 * hops + 16 * 4 * rays) << shape;
    EXPECT_EQ(messages(r, "packets"), hops);
    std::uint64_t links = 0;
    for (const Json& link : r["links"]) links += link["bytes"].get<std::uint64_t>();
    EXPECT_EQ(links, bytes(r, "packets"));
  }
}

// No link is busy for less than its bytes need, nor for a width more than a packet's last piece leaves unused.
TEST_F(ByteLedger, LinksAreBusyAsLongAsTheirBytesNeed) {
  for (const std::uint64_t width : {1, 7, 32}) {
    const Json r = report(kMachine, {fmt::format("topology.link.bytes_per_cycle={}", width)});
    for (const Json& link : r["links"]) {
      const std::uint64_t busy = link["cycles"]["busy"], moved = link["bytes"], packets = link["packets"];
      EXPECT_GE(busy * width, moved);
      EXPECT_LE(busy * width, moved + packets * (width - 1));
    }
  }
}

TEST_F(ByteLedger, ShapesFetchedAreLines) {
  for (const char* set : {"memory.shared_by=4", "memory.shared_by=1", "collections.traversal=treelet",
                          "topology.shape=independent", "memory.line_bytes=128"}) {
    const Json r = report(kMachine, {set});
    std::uint64_t lines = 0, requests = 0;
    for (const Json& cache : r["memory"]["caches"]) {
      lines += cache["lines"].get<std::uint64_t>();
      requests += cache["requests"].get<std::uint64_t>();
    }
    const std::uint64_t line_bytes = r["config"]["memory"]["line_bytes"];
    EXPECT_EQ(bytes(r, "shape data"), lines * line_bytes) << set;
    EXPECT_EQ(bytes(r, "shape requests"), 16 * requests) << set;
    EXPECT_EQ(bytes(r, "lines"), r["memory"]["dram_bytes"]) << set;
    EXPECT_EQ(bytes(r, "line requests"), 8 * r["memory"]["dram_lines"].get<std::uint64_t>()) << set;
  }
}

// A request for a strip that ends by its flag has two bytes less than one that names its length, as those for
// instances' records do; what is looked up behind the end goes to nobody.
TEST_F(ByteLedger, StripsThatEndByTheirFlagAreAskedForInFewerBytes) {
  const Json r = report(kMachine, {"memory.strip_end=flag", "memory.strip_ahead=2"});
  std::uint64_t lines = 0, past = 0, requests = 0;
  for (const Json& cache : r["memory"]["caches"]) {
    lines += cache["lines"].get<std::uint64_t>();
    past += cache["past_end"].get<std::uint64_t>();
    requests += cache["requests"].get<std::uint64_t>();
  }
  ASSERT_GT(past, 0u);
  EXPECT_EQ(bytes(r, "shape data"), (lines - past) * 64);
  EXPECT_GT(bytes(r, "shape requests"), 14 * requests);
  EXPECT_LT(bytes(r, "shape requests"), 16 * requests);
  EXPECT_EQ(bytes(r, "lines"), r["memory"]["dram_bytes"]);
}

// A spilled entry goes to memory with its request, and comes back as lines.
TEST_F(ByteLedger, SpilledEntriesTravelBothWays) {
  const Json r = report(kMachine, {"collections.when_full=spill", "collections.capacity=64"});
  std::uint64_t requests = 0, written = 0;
  for (const Json& cache : r["memory"]["caches"]) {
    requests += cache["requests"].get<std::uint64_t>();
    written += cache["written"].get<std::uint64_t>();
  }
  ASSERT_GT(written, 0u);
  EXPECT_EQ(bytes(r, "written lines"), written * 64);
  EXPECT_EQ(r["memory"]["dram_lines_written"], written);
  EXPECT_GT(messages(r, "shape requests"), requests);  // writes are requests without an answer
  EXPECT_EQ(bytes(r, "shape requests"),
            16 * messages(r, "shape requests") + r["collections"]["spill_bytes_written"].get<std::uint64_t>());
}

TEST_F(ByteLedger, RaysAreRecordsAndIds) {
  for (const char* shape : {"ring", "independent", "bus"}) {
    const Json r = report(kMachine, {fmt::format("topology.shape={}", shape)});
    EXPECT_EQ(bytes(r, "new rays"), (64 + 4) * r["rays"]["emitted"].get<std::uint64_t>()) << shape;
    EXPECT_EQ(bytes(r, "completed rays"), 64 * r["rays"]["completed"].get<std::uint64_t>()) << shape;
  }
}

TEST_F(ByteLedger, AnyHitCallsGoThereAndBack) {
  write_scenes_and_rays(program_);
  for (const char* shape : {"ring", "independent"}) {
    const Json r =
        report(text(BaseMachine::kLayers), {"testers.any_hit=shader", fmt::format("topology.shape={}", shape)});
    const std::uint64_t calls = r["tests"]["any_hit"]["count"], answers = bytes(r, "any-hit answers");
    ASSERT_GT(calls, 0u);
    EXPECT_EQ(bytes(r, "any-hit questions"), 16 * calls + answers / 2) << shape;
    EXPECT_EQ(messages(r, "any-hit questions"), messages(r, "any-hit answers")) << shape;
  }
}

TEST_F(ByteLedger, ResourcesThatShadeGetRecordsAndSendResults) {
  const Json r = report(kMachine, {"shading.idle_resources_shade=true", "shading.cycles_per_shade=200"});
  const std::uint64_t jobs = messages(r, "shading jobs");
  ASSERT_GT(jobs, 0u);
  EXPECT_EQ(bytes(r, "shading jobs"), 64 * jobs);
  EXPECT_EQ(bytes(r, "notes and results"), 64 * jobs + 4 * messages(r, "notes and results"));
}

// Messages that were free: a wire of a byte a cycle makes a run longer though no packet travels.
TEST_F(ByteLedger, WiresBesideTheLinksTakeTime) {
  const auto cycles = [&](const char* shape, int width) {
    return report(kMachine, {fmt::format("topology.shape={}", shape), "collections.home=local",
                             fmt::format("topology.link.bytes_per_cycle={}", width)})["engine"]["cycles"]
        .get<std::uint64_t>();
  };
  for (const char* shape : {"ring", "independent"}) EXPECT_GT(cycles(shape, 1), cycles(shape, 64)) << shape;
}

TEST(SideWire, AMessageOccupiesItForItsWidths) {
  LinkConfig link;
  link.bytes_per_cycle = 4;
  ringbus::cycle::SideWire wire(link, 10);
  EXPECT_EQ(wire.send(4, 100), 110u);   // one width: as if only the latency counted
  EXPECT_EQ(wire.send(16, 100), 114u);  // from cycle 101 on, its tail three cycles behind its head
  EXPECT_EQ(wire.send(1, 100), 115u);
  EXPECT_EQ(wire.send(5, 200), 211u);
}

}  // namespace
}  // namespace carousel::byte_ledger_test

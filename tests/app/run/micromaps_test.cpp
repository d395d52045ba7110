// Opacity micromaps in whole machines: pictures are the same, any-hit calls fewer, and bytes and cycles are charged.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::micromaps_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

constexpr const char* kMachine =
    "scene: {builtin: foliage, triangles: 240}\n"
    "image: {width: 20, height: 12, samples: 1, max_depth: 3}\n"
    "engine: {kind: cycle, what_if: false}\n"
    "topology: {resources: 4}\n"
    "rays: {slots_per_resource: 128}\n"
    "packets: {rays: 8}\n"
    "collections: {ready: 8}\n"
    "memory: {shape_buffer_kib: 64}\n"
    "bvh: {micromaps: {states: four, level: 5}}\n";

class Micromaps : public testing::Test {
 protected:
  Outcome try_run(const std::vector<std::string>& sets) {
    program_.write("machine.yaml", kMachine);
    std::vector<std::string> arguments{"run", "machine.yaml", "--out", "out", "--force", "--quiet", "--no-html"};
    add_sets(arguments, sets);
    return program_.run(arguments);
  }
  Json run(const std::vector<std::string>& sets) {
    const Outcome outcome = try_run(sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? Json::parse(program_.read("out/report.json")) : Json();
  }
  Program program_;
};

double calls(const Json& r) {
  return r["tests"].contains("any_hit") ? r["tests"]["any_hit"]["count"].get<double>() : 0;
}

// Checked builds also compare every known state with the any-hit call.
TEST_F(Micromaps, ChangeNoPictureAndSaveFourOfFiveCalls) {
  const std::string none = "bvh.micromaps.states=none";
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {}, {"scene.triangles=1500", "image.width=40", "image.height=24", "scene.camera=1"}}) {
    std::vector<std::string> without = more;
    without.push_back(none);
    const Json plain = run(without);
    const auto machine = [&](std::vector<std::string> sets) {
      sets.insert(sets.end(), more.begin(), more.end());
      SCOPED_TRACE(testing::PrintToString(sets));
      const Json r = run(sets);
      EXPECT_EQ(r["digest"], plain["digest"]);
      return r;
    };
    const Json four = machine({"verify=reference"});
    EXPECT_EQ(four["verify"]["mismatches"], 0);
    EXPECT_GT(calls(plain), 300);
    EXPECT_LE(calls(four), calls(plain) / 5);
    const Json& maps = four["micromaps"];
    EXPECT_EQ(maps["lookups"].get<double>(), calls(four) + maps["calls_saved"].get<double>());
    EXPECT_EQ(maps["lookups"], four["tests"]["micromap"]["count"]);
    EXPECT_EQ(maps["calls_saved"], four["tests"]["micromap_known"]["count"]);
    const auto sum = [](const Json& states) {
      return states["opaque"].get<std::uint64_t>() + states["transparent"].get<std::uint64_t>() +
             states["unknown"].get<std::uint64_t>();
    };
    const std::uint64_t mapped = maps["maps"];
    EXPECT_EQ(maps["micro_triangles_each"], 1024);
    EXPECT_EQ(maps["map_bytes"], 256);
    EXPECT_EQ(sum(maps["micro_triangles"]), 1024 * mapped);
    EXPECT_EQ(maps["bytes"].get<std::uint64_t>(), 4 * (sum(maps["triangles"]) + mapped) + 256 * mapped);
    const Json two = machine({"bvh.micromaps.states=two"});
    EXPECT_GT(calls(two), calls(four));
    if (!more.empty()) continue;  // the shapes of machines once are enough
    machine({"engine.kind=native"});
    machine({"topology.shape=bidirectional", "bvh.storage=quantised", "bvh.micromaps.level=2"});
    machine({"topology.shape=bus", "bvh.mixed_triangles=4"});
    machine({"topology.shape=independent", "testers.any_hit=shader"});
    machine({"topology.shape=independent", "testers.simt.warp=8"});
    machine({"packets.shapes=single", "memory.strip_end=flag", "accuracy.triangle=double"});
    machine({"collections.traversal=treelet", "bvh.merge=world", "bvh.micromaps.level=0"});
  }
}

TEST_F(Micromaps, ArePaidFor) {
  const Json plain = run({"bvh.micromaps.states=none", "energy.profile=n45"}), r = run({"energy.profile=n45"});
  const auto number = [](const Json& of, const char* at) { return of[Json::json_pointer(at)].get<double>(); };
  // The crown's mesh is there once, and each region of memory begins with 64 bytes.
  EXPECT_NEAR(number(r, "/structure/bytes") - number(plain, "/structure/bytes"), number(r, "/micromaps/bytes"), 128);
  const auto shape_bytes = [](const Json& of) {
    for (const Json& row : of["bytes"])
      if (row["what"] == "shape data") return row["bytes"].get<double>();
    return 0.0;
  };
  EXPECT_GT(shape_bytes(r), 1.2 * shape_bytes(plain));
  EXPECT_FALSE(plain["energy"]["parts"].contains("micromap_lookups") &&
               number(plain, "/energy/parts/micromap_lookups/events") > 0);
  EXPECT_EQ(number(r, "/energy/parts/micromap_lookups/events"), number(r, "/micromaps/lookups"));
  EXPECT_NEAR(number(r, "/energy/parts/micromap_lookups/pj_each"), 12.7, 1e-4);
  EXPECT_NEAR(number(r, "/area/parts/test_units/mm2") - number(plain, "/area/parts/test_units/mm2"), 4 * 0.021, 1e-5);
  EXPECT_GT(number(run({"testers.micromap_unit.latency_cycles=200"}), "/engine/cycles"), number(r, "/engine/cycles"));
}

TEST_F(Micromaps, AreRefusedWhereTheyHaveNoPlace) {
  const auto refused = [&](const std::string& set) {
    const Outcome outcome = try_run({set});
    EXPECT_EQ(outcome.status, 2) << set;
    return outcome.err;
  };
  EXPECT_THAT(refused("bvh.leaves=strips"), HasSubstr("bvh.leaves: strips of triangles have no room for micromaps"));
  EXPECT_THAT(refused("bvh.treelets.bytes=4096"), HasSubstr("expected 0, or bvh.micromaps.states: none; found 4096"));
  EXPECT_THAT(refused("bvh.micromaps.level=7"), HasSubstr("bvh.micromaps.level: expected an integer from 0 to 6"));
  EXPECT_THAT(refused("bvh.micromaps.states=three"), HasSubstr("none, two"));
}

}  // namespace
}  // namespace carousel::micromaps_test

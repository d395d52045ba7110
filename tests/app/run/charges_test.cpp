// What costs nothing in a run (`charges`): each key that charges something makes the machine slower, or moves more
// bytes.
#include "app/charges/charges.h"

#include <set>
#include <string>

#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::charges_test {
namespace {

// Memory is near and slow enough for the number of lines on their way to matter, and surfaces have effects.
const char* const kMachine =
    "scene: {builtin: spheres, triangles: 3000}\nimage: {width: 24, height: 16, samples: 1, max_depth: 3}\n"
    "topology: {resources: 4}\npackets: {rays: 16}\ncollections: {ready: 16}\nrays: {slots_per_resource: 64}\n"
    "memory: {l1_kib: 4, l2_kib: 16, shape_buffer_kib: 2, dram_latency_cycles: 400}\n";

class Charges : public TimedRun {
 protected:
  static std::vector<std::string> names(const Json& report) {
    std::vector<std::string> out;
    for (const Json& charge : report["charges"]) out.push_back(charge["name"]);
    return out;
  }
  static bool lists(const Json& report, const std::string& name) {
    const auto all = names(report);
    return std::find(all.begin(), all.end(), name) != all.end();
  }
  static std::uint64_t bytes_of(const Json& report) {
    std::uint64_t sum = 0;
    for (const Json& row : report["bytes"]) sum += row["bytes"].get<std::uint64_t>();
    return sum;
  }
  /// Each key of the list takes its row away, costs cycles or bytes, and changes no hit.
  void expect_dearer(const std::string& machine) {
    const Json list = report(machine)["charges"];
    std::size_t keys = 0;
    for (const Json& charge : list) {
      const std::string name = charge["name"];
      if (!charge.contains("set")) continue;
      ++keys;
      // 64 lines on their way hold up a memory that is far.
      const std::string far =
          name == "l2_misses" ? "memory.dram_latency_cycles=2000" : "memory.dram_latency_cycles=400";
      const Json base = report(machine, {far}), charged = report(machine, {far, charge["set"].get<std::string>()});
      EXPECT_FALSE(lists(charged, name)) << name;
      EXPECT_EQ(names(charged).size() + 1, names(base).size()) << name;
      const bool more = charged["engine"]["cycles"] > base["engine"]["cycles"] || bytes_of(charged) > bytes_of(base);
      EXPECT_TRUE(more) << name;
      EXPECT_EQ(charged["digest"], base["digest"]) << name;
    }
    EXPECT_GT(keys, 5u);
  }
};

TEST_F(Charges, EachKeyTakesItsRowAwayAndCostsCyclesOrBytes) {
  const std::string programs =
      std::string(kMachine) + "shading: {program: {default: built_in}, workers: 2, lanes: 4}\n";
  for (const std::string& machine : {std::string(kMachine), programs}) expect_dearer(machine);
}

TEST_F(Charges, WithoutAKeyAreOfTheMachinesThatMeetThem) {
  const auto lists_in = [&](const char* name, const std::string& set) {
    return lists(report(kMachine, set.empty() ? std::vector<std::string>{} : std::vector{set}), name);
  };
  EXPECT_TRUE(lists_in("shape_reads", ""));
  EXPECT_TRUE(lists_in("ray_writes", ""));
  EXPECT_TRUE(lists_in("ray_writes", "rays.reads_per_cycle=2")) << "reads have ports then, writes do not";
  EXPECT_FALSE(lists_in("sorted_vectors", ""));
  EXPECT_TRUE(lists_in("sorted_vectors", "shading.sort=shader"));
  EXPECT_FALSE(lists_in("loaded_programs", ""));
  EXPECT_TRUE(lists_in("loaded_programs", "shading.program.default=built_in"));
  EXPECT_FALSE(lists_in("instructions", ""));
  EXPECT_FALSE(lists_in("moved_vertices", ""));
}

// Of a shape and of its drawing they are the same.
TEST_F(Charges, OfRoutersAreTheirCrossbarsAndTheRoomThatNothingBounds) {
  const std::string drawn = "topology={shape: graph, nodes: [{name: r, count: 4}, {name: x, kind: router, buffers: ";
  const std::string links = "}], links: [{from: 'r[*]', to: x, both: true}]}";
  const auto expect = [&](const std::vector<std::string>& sets, bool crossbars, bool room, bool messages) {
    const Json all = report(kMachine, sets);
    EXPECT_EQ(lists(all, "crossbars"), crossbars) << testing::PrintToString(sets);
    EXPECT_EQ(lists(all, "router_room"), room) << testing::PrintToString(sets);
    EXPECT_EQ(lists(all, "message_room"), messages) << testing::PrintToString(sets);
  };
  expect({}, false, false, false);
  expect({"topology={shape: graph, nodes: [{name: r, count: 4}], links: [{ring: 'r[*]'}]}"}, false, false, false);
  expect({"topology.shape=bus"}, false, false, false);
  expect({"topology.shape=hierarchical", "topology.groups=2"}, true, true, false);
  expect({drawn + "auto" + links}, true, true, false);
  expect({drawn + "5" + links}, true, false, false);
  expect({"topology={shape: graph, nodes: [{name: r, count: 4}, {name: s, kind: shading}], links: [{ring: 'r[*]'}, "
          "{from: 'r[*]', to: s, both: true, carries: [new_rays]}]}"},
         false, false, true);
}

// The places of a router, as many for each link that leaves it, have the area of places at the ends of links.
TEST_F(Charges, BuffersOfRoutersHaveArea) {
  const auto area = [&](const std::string& buffers, const std::string& depth) {
    return report(kMachine, {"energy.profile=n7",
                             "topology={shape: graph, nodes: [{name: r, count: 4}, {name: x, kind: "
                             "router, buffers: " +
                                 buffers + "}], links: [{from: 'r[*]', to: x}, {from: x, to: 'r[*]', depth: " + depth +
                                 "}]}"})["area"]["parts"]["link_queues"]["mm2"]
        .get<double>();
  };
  const double bare = area("auto", "8");
  EXPECT_NEAR(area("8", "8") - bare, area("auto", "16") - bare, 1e-12);
  EXPECT_GT(area("8", "8"), bare);
}

// A router between two rings of slots has them for packets that get on a ring, and for those that get off.
TEST_F(Charges, BuffersBesideRingsHaveAreaOnBothSides) {
  const auto area = [&](const std::string& links, int buffers) {
    return report(kMachine, {"energy.profile=n7",
                             fmt::format("topology={{shape: graph, nodes: [{{name: r, count: 4}}, {{name: q, count: "
                                         "4}}, {{name: x, kind: router, buffers: {}}}], links: [{}]}}",
                                         buffers, links)})["area"]["parts"]["link_queues"]["mm2"]
        .get<double>();
  };
  const auto of_eight = [&](const std::string& links) { return area(links, 72) - area(links, 64); };
  const std::string slots = "{ring: 'r[*], x', stops: {rule: slots}}, {ring: 'q[*], x', stops: {rule: slots}}",
                    links = "{ring: 'r[*], x'}, {ring: 'q[*], x'}";
  EXPECT_GT(of_eight(links), 0);
  EXPECT_NEAR(of_eight(slots), 2 * of_eight(links), 1e-12);
}

TEST_F(Charges, OfSeveralFramesAreMovedVertices) {
  const Json frames = report(
      "scene: {builtin: instances, instances: 20, time: 0}\nimage: {width: 12, height: 8, samples: 1, max_depth: 1}\n"
      "topology: {resources: 2}\nrays: {slots_per_resource: 64}\ncollections: {when_full: spill}\n"
      "frames: {count: 2, step: 0.04, update: refit}\n");
  EXPECT_TRUE(lists(frames, "moved_vertices"));
}

TEST_F(Charges, AreOfTheMachineAndSceneOfTheRun) {
  const Json ring = report(kMachine), stack = report(kMachine, {"topology.shape=independent"});
  EXPECT_TRUE(lists(ring, "sorted_ids"));
  EXPECT_FALSE(lists(stack, "sorted_ids"));
  EXPECT_FALSE(lists(ring, "stack"));
  EXPECT_TRUE(lists(stack, "stack"));
  EXPECT_TRUE(lists(report(kMachine, {"bvh.storage=quantised"}), "quantised_nodes"));
  EXPECT_TRUE(lists(report(kMachine, {"bvh.storage=quantised_12"}), "quantised_nodes"));
  EXPECT_FALSE(lists(ring, "quantised_nodes"));
  std::set<std::string> once;
  for (const app::Charge& charge : app::all_charges()) EXPECT_TRUE(once.insert(charge.name).second) << charge.name;
  EXPECT_FALSE(lists(ring, "sky_map"));
  EXPECT_FALSE(lists(report(kMachine, {"memory.l1_kib=0"}), "l1_misses"));
  EXPECT_FALSE(report(kMachine, {"engine.kind=native"}).contains("charges"));
}

TEST_F(Charges, ChargeAllLeavesOnlyWhatHasNoKey) {
  const Json base = report(kMachine);
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"run", "machine.yaml", "--charge-all", "--quiet", "--force", "--out", "all"};
    for (const char* set : {"engine.kind=cycle", "engine.what_if=false"}) words.insert(words.end(), {"--set", set});
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = program_.run(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(program_.read("all/report.json"));
  };
  const Json all = run({});
  for (const Json& charge : all["charges"]) EXPECT_FALSE(charge.contains("key")) << charge.dump();
  EXPECT_GT(all["engine"]["cycles"], base["engine"]["cycles"]);
  EXPECT_EQ(all["digest"], base["digest"]);
  // The resolved configuration is the charged machine.
  const Outcome again = program_.run({"run", "all/config.resolved.yaml", "--quiet", "--force", "--out", "again"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(Json::parse(program_.read("again/report.json"))["engine"]["epochs"], all["engine"]["epochs"]);
  // What the user sets stays, and what the machine may not have is left as it is.
  const Json own = run({"--set", "memory.film=free", "--set", "rays.placement=addressed"});
  EXPECT_TRUE(lists(own, "film"));
  EXPECT_TRUE(lists(own, "ray_records"));
  EXPECT_FALSE(lists(own, "path_state"));
}

}  // namespace
}  // namespace carousel::charges_test

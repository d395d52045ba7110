// Where the cycles of all rays go (`ray_time`, `heat`): the stages add up to the cycle on machines of every kind, and
// of a ray that is alone they are those that `carousel follow` tells of it, which are noted elsewhere.
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/statistics/ray_stage_counts.h"
#include "core/system/memory_budget.h"
#include "scene/images/image_decode.h"
#include "tests/app/time/timed_run.h"

namespace carousel::ray_time_test {
namespace {

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 16, height: 12, samples: 1, max_depth: 3}\n"
    "topology: {resources: 4}\npackets: {rays: 8}\ncollections: {ready: 8}\nrays: {slots_per_resource: 24}\n";

class RayTime : public TimedRun {
 protected:
  static std::uint64_t sum(const Json& row) {
    std::uint64_t cycles = 0;
    for (const Counter<RayStageCounts>& stage : kCounters<RayStageCounts>)
      cycles += row[stage.name].get<std::uint64_t>();
    return cycles;
  }

  /// What every ledger keeps.
  static void expect_closed(const Json& report, const std::string& machine) {
    ASSERT_TRUE(report.contains("ray_time")) << machine;
    const Json& time = report["ray_time"];
    EXPECT_EQ(time["rays"], report["rays"]["completed"]) << machine;
    EXPECT_EQ(sum(time), time["cycles"]) << machine;
    EXPECT_NEAR(time["latency"].get<double>(), time["cycles"].get<double>() / time["rays"].get<double>(), 1e-6);
    std::uint64_t cycles = 0, in_slots = 0;
    for (const Json& row : time["by_kind"]) {
      EXPECT_EQ(sum(row), row["cycles"]) << machine;
      cycles += row["cycles"].get<std::uint64_t>();
      // No ray takes longer than the run: a sum that has wrapped round would.
      EXPECT_LE(row["cycles"].get<double>(), row["rays"].get<double>() * report["engine"]["cycles"].get<double>());
    }
    EXPECT_EQ(cycles, time["cycles"]) << machine;
    for (const Counter<RayStageCounts>& stage : kCounters<RayStageCounts>)
      if (const std::string name = stage.name; name != "slot" && name != "shade_queue" && name != "shading")
        in_slots += time[name].get<std::uint64_t>();
    // Slots have a clock of their own.
    const Json& residence = report["rays"]["residence"];
    EXPECT_NEAR(static_cast<double>(in_slots), residence["mean"].get<double>() * residence["count"].get<double>(), 0.5)
        << machine;
  }
};

TEST_F(RayTime, ClosesToTheCycleOnMachinesOfEveryKind) {
  for (const char* sets : {"",
                           "collections.traversal=ordered",
                           "collections.traversal=treelet",
                           "topology.shape=bidirectional",
                           "topology.shape=hierarchical topology.groups=2",
                           "topology.shape=point_to_point",
                           "topology.shape=bus",
                           "topology.shape=central topology.resources=1",
                           "topology.shape=independent",
                           "topology.visit=owners",
                           "collections.home=local",
                           "collections.home=hash collections.when_full=spill",
                           "packets.shapes=single",
                           "packets.results=message",
                           "memory.fetch=packet packets.carry=data",
                           "rays.placement=first_taker",
                           "rays.placement=addressed",
                           "shading.lanes=4",
                           "shading.idle_resources_shade=true",
                           "collections.when_full=spill collections.capacity=64",
                           "memory.path_state=memory",
                           "testers.contexts=8",
                           "engine.threads=3"}) {
    std::istringstream words(sets);
    std::vector<std::string> list;
    for (std::string word; words >> word;) list.push_back(word);
    expect_closed(report(kMachine, list), sets);
  }
}

TEST_F(RayTime, IsTheSameOnAnyNumberOfThreads) {
  for (const char* shape : {"topology.shape=ring", "topology.shape=bus", "topology.shape=independent"}) {
    const Json one = report(kMachine, {shape, "engine.threads=1"}),
               more = report(kMachine, {shape, "engine.threads=3"});
    EXPECT_EQ(one["ray_time"], more["ray_time"]) << shape;
  }
}

// `follow` puts the life of a ray together from notes of its packets' ways. A ray that goes depth-first is in one
// packet at a time, and behind its test in the packet it is `home` here what it is in several stages there.
TEST_F(RayTime, OfALonelyRayIsItsLife) {
  program_.write("ray.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,9,0,0.1,-1,0.1,0,inf\n");
  const std::map<std::string, std::string> same{{"waits for a slot", "slot"},
                                                {"is loaded", "load"},
                                                {"in a collection", "collection"},
                                                {"in test", "test"},
                                                {"on its way to shading", "to_shading"},
                                                {"waits for a shader worker", "shade_queue"},
                                                {"is shaded", "shading"},
                                                {"waits for shapes", "shapes"}};
  for (const char* visit : {"all", "owners"}) {
    const std::vector<std::string> sets{fmt::format("topology.visit={}", visit), "collections.traversal=ordered",
                                        "topology.link.latency_cycles=3"};
    const Json time = report(std::string(kMachine).replace(0, 0, "workload: {rays_from: ray.csv}\n"), sets)["ray_time"];
    std::vector<std::string> words{"follow", "machine.yaml", "--ray", "0",
                                   "--json", "--quiet",      "--set", "engine.kind=cycle"};
    add_sets(words, sets);
    const Outcome outcome = program_.run(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json life = Json::parse(outcome.out);
    ASSERT_GT(life["tests"].size(), 2u);
    EXPECT_EQ(time["cycles"].get<double>(), life["latency"].get<double>());
    std::map<std::string, double> told;
    for (const Json& stage : life["stages"])
      if (const auto found = same.find(stage["stage"]); found != same.end())
        told[found->second] += stage["length"].get<double>();
    for (const auto& [text, name] : same) EXPECT_EQ(time[name].get<double>(), told[name]) << visit << ", " << name;
    EXPECT_GT(time["home"], 0);
    EXPECT_GT(time["link"], 0);
  }
}

TEST_F(RayTime, GrowsWhereThePartIsSlower) {
  const Json base = report(kMachine)["ray_time"];
  for (const auto& [set, stage] :
       {std::pair{"shading.cycles_per_shade=400", "shading"}, std::pair{"topology.link.latency_cycles=40", "link"},
        std::pair{"memory.l2_latency_cycles=400", "shapes"}, std::pair{"testers.box.latency_cycles=300", "test"},
        std::pair{"packets.ids_per_cycle=1", "dispatch"}, std::pair{"shading.workers=1", "shade_queue"}})
    EXPECT_GT(report(kMachine, {set})["ray_time"][stage].get<double>(), 1.3 * base[stage].get<double>()) << set;
}

// Camera rays are made when slots are free, so that those wait that other rays cause. How many these are depends on how
// many are under way: with fewer slots the sum over all rays may be smaller. It is least where every ray has a slot.
TEST_F(RayTime, ASlotIsWaitedForWhereThereIsNone) {
  const Json few = report(kMachine)["ray_time"], enough = report(kMachine, {"rays.slots_per_resource=128"})["ray_time"],
             many = report(kMachine, {"rays.slots_per_resource=1024"})["ray_time"];
  EXPECT_EQ(enough, many);
  EXPECT_GT(few["slot"].get<double>(), 10 * many["slot"].get<double>());
  for (const Json& row : many["by_kind"])
    if (row["kind"] == "camera") {
      EXPECT_EQ(row["slot"], 0);
    }
}

TEST_F(RayTime, IsAbsentWhereRaysAreNotKnownByThemselves) {
  EXPECT_FALSE(report(kMachine, {"bundles.size=4"}).contains("ray_time"));
  EXPECT_FALSE(report(kMachine, {"faults.resource.kind=stop", "faults.resource.after_rays=20"}).contains("ray_time"));
  EXPECT_FALSE(report(kMachine, {"engine.kind=native"}).contains("ray_time"));
  EXPECT_FALSE(report(kMachine, {"topology.shape=independent", "testers.simt.warp=8"}).contains("ray_time"));
}

// The pixels share the rays' cycles out.
TEST_F(RayTime, OfThePixelsIsThatOfTheRays) {
  for (const char* shape : {"ring", "independent", "bus"}) {
    const Json whole = report(kMachine, {fmt::format("topology.shape={}", shape)});
    const Outcome outcome =
        program_.run({"run", "machine.yaml", "--set", "engine.kind=cycle", "--set", "engine.what_if=false", "--set",
                      fmt::format("topology.shape={}", shape), "--heat", "log", "--quiet", "--force", "--out", "maps"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::istringstream lines(program_.read("maps/heat.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "x,y,rays,cycles,tests,hops,waiting");
    std::uint64_t rays = 0, cycles = 0, tests = 0, waiting = 0, most = 0, pixels = 0;
    for (std::uint64_t x = 0, y = 0, r = 0, c = 0, t = 0, h = 0, w = 0; std::getline(lines, line); ++pixels) {
      ASSERT_EQ(std::sscanf(line.c_str(), "%lu,%lu,%lu,%lu,%lu,%lu,%lu", &x, &y, &r, &c, &t, &h, &w), 7) << line;
      EXPECT_EQ(y * 16 + x, pixels);
      rays += r, cycles += c, tests += t, waiting += w;
      most = std::max(most, c);
    }
    EXPECT_EQ(pixels, 16u * 12u);
    EXPECT_EQ(rays, whole["rays"]["completed"]);
    EXPECT_EQ(cycles, whole["ray_time"]["cycles"]);
    EXPECT_EQ(cycles - waiting, whole["ray_time"]["test"]);
    EXPECT_GT(tests, rays);
    EXPECT_FALSE(whole.contains("heat"));
    const Json heat = Json::parse(program_.read("maps/report.json"))["heat"];
    EXPECT_EQ(heat["slowest"].size(), 10u);
    EXPECT_EQ(heat["slowest"][0]["cycles"], most);
    for (const char* name : {"cycles", "tests", "hops", "waiting"})
      EXPECT_TRUE(std::filesystem::exists(program_.folder() / fmt::format("maps/heat_{}.png", name)));
  }
}

// Cycles of pixels differ less than they are large: the least bright pixel of any cost is not near the brightest.
TEST_F(RayTime, LogarithmicMapsBeginAtTheLeastCost) {
  program_.write("machine.yaml", kMachine);
  const Outcome outcome = program_.run({"run", "machine.yaml", "--set", "engine.kind=cycle", "--set",
                                        "engine.what_if=false", "--heat", "log", "--quiet", "--out", "maps"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::string png = program_.read("maps/heat_cycles.png");
  MemoryBudget memory(1 << 20);
  const scene::Image map =
      scene::decode_image(std::span(reinterpret_cast<const unsigned char*>(png.data()), png.size()), memory);
  int least = 255, most = 0;
  for (std::size_t i = 0; i < map.rgba.size(); i += 4) {
    least = std::min<int>(least, map.rgba[i]);
    most = std::max<int>(most, map.rgba[i]);
  }
  EXPECT_LT(least, 60) << "red of the stops: 0, 80, 190, 250, 252";
  EXPECT_GT(most, 245);
  EXPECT_THAT(program_.read("maps/report.html"), testing::HasSubstr("id=\"heat-words\""));
}

TEST_F(RayTime, MapsAreRefusedWherePixelsAreNotKnown) {
  program_.write("machine.yaml", kMachine);
  for (const char* set : {"bundles.size=4", "engine.kind=native", "rays.placement=addressed", "testers.simt.warp=8"}) {
    std::vector<std::string> words{"run",    "machine.yaml", "--set",   "engine.kind=cycle", "--set", set,
                                   "--heat", "linear",       "--quiet", "--force",           "--out", "none"};
    if (std::string(set).find("simt") != std::string::npos)
      words.insert(words.end(), {"--set", "topology.shape=independent"});
    const Outcome outcome = program_.run(words);
    EXPECT_EQ(outcome.status, 2) << set;
    EXPECT_NE(outcome.err.find("--heat"), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(program_.folder() / "none")) << set;
  }
}

}  // namespace
}  // namespace carousel::ray_time_test

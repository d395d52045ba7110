// Rays that look for several nearest hits (rays.query.nearest), on both engines, as a user asks for them.
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/hits_of_rays.h"

namespace carousel::nearest_test {
namespace {

using Json = nlohmann::json;

Json report_of(const Program& program) {
  return Json::parse(program.read("out/report.json"));
}

// A machine whose rays are resumed visits at most half of the nodes that one does whose rays begin again, with 16 hits,
// and gets them sooner.
TEST(Nearest, ResumingVisitsHalfOfTheNodes) {
  Program program;
  program.write("soup.gltf", soup().text());
  program.write("rays.csv", rays_through(soup().load().bounds(), 200, 5));
  for (const std::string machine : {"topology.shape=independent", "collections.traversal=ordered"}) {
    program.write("rays.yaml",
                  "scene: {file: soup.gltf}\nworkload: {rays_from: rays.csv}\n"
                  "rays: {slots_per_resource: 64, query: {nearest: 16, buffer: 2}}\nengine: {kind: cycle}\n");
    std::vector<Json> reports;
    for (const std::string rounds : {"restart", "resume"}) {
      const Outcome outcome = run(program, machine + " rays.query.rounds=" + rounds);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      reports.push_back(report_of(program));
    }
    const Json &restart = reports[0]["nearest"], &resume = reports[1]["nearest"];
    EXPECT_EQ(restart["digest"], resume["digest"]);
    EXPECT_EQ(restart["hits"], resume["hits"]);
    EXPECT_GT(restart["rounds"].get<int>(), restart["rays"].get<int>() * 3 / 2);
    EXPECT_LE(resume["visits"].get<int>() * 2, restart["visits"].get<int>()) << machine;
    EXPECT_LT(reports[1]["engine"]["cycles"].get<int>(), reports[0]["engine"]["cycles"].get<int>()) << machine;
    EXPECT_EQ(restart["waiting_bytes"], 0);
    EXPECT_GT(resume["waiting_bytes"].get<int>(), 0);
    // Each round's visits are those of the whole.
    for (const Json& one : {restart, resume}) {
      std::uint64_t rays = 0, visits = 0;
      for (const Json& round : one["by_round"]) {
        rays += round["rays"].get<std::uint64_t>();
        visits += round["visits"].get<std::uint64_t>();
      }
      EXPECT_EQ(rays, one["rounds"]);
      EXPECT_EQ(visits, one["visits"]);
    }
  }
}

// What several hits cost: steps of insertions, bytes of the buffers and of the hits that leave, joules and area.
TEST(Nearest, CostsTimeBytesJoulesAndArea) {
  Program program;
  program.write("soup.gltf", soup().text());
  program.write("rays.csv", rays_through(soup().load().bounds(), 150, 7));
  program.write("rays.yaml",
                "scene: {file: soup.gltf}\nworkload: {rays_from: rays.csv}\n"
                "rays: {slots_per_resource: 64}\nengine: {kind: cycle}\nenergy: {profile: n45}\n");
  const auto reported = [&](const std::string& sets) {
    const Outcome outcome = run(program, sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return report_of(program);
  };
  const Json one = reported("collections.ready=1"), many = reported("collections.ready=1 rays.query.nearest=16"),
             slow = reported("collections.ready=1 rays.query.nearest=16 testers.hit_buffer.interval_cycles=50");
  EXPECT_FALSE(one.contains("nearest"));
  EXPECT_FALSE(one["tests"].contains("buffer_steps"));
  const Json& nearest = many["nearest"];
  const std::uint64_t steps = many["tests"]["buffer_steps"]["count"], hits = nearest["hits"], rays = nearest["rays"],
                      inserted = nearest["inserted"], evicted = nearest["evicted"];
  EXPECT_GE(steps, nearest["offered"]);
  EXPECT_EQ(inserted - evicted, hits);
  EXPECT_GE(nearest["written_bytes"].get<std::uint64_t>(), 20 * inserted);
  EXPECT_EQ(nearest["rounds"], rays);
  EXPECT_EQ(nearest["buffer_bytes"], 20 * 16 * 64 * many["resources"].size());
  EXPECT_GT(slow["engine"]["cycles"].get<int>(), many["engine"]["cycles"].get<int>());
  // A ray's first hit goes with its record, the others behind it.
  const auto sent = [](const Json& report) {
    for (const Json& row : report["bytes"])
      if (row["what"] == "completed rays") return row["bytes"].get<std::uint64_t>();
    return std::uint64_t{0};
  };
  std::uint64_t first = 0;
  std::istringstream csv(program.read("out/hits.csv"));
  std::string last;
  for (std::string line; std::getline(csv, line);)
    if (const std::string ray = line.substr(0, line.find(',')); ray != "ray") {
      const bool camera = line.find(",camera,") != line.npos, hit = line.find(",inf,,,,") == line.npos;
      first += ray != last && camera && hit;
      last = ray;
    }
  EXPECT_EQ(sent(many) - sent(one), 20 * (hits - first));
  const auto part = [](const Json& report, const char* section, const char* name, const char* key) {
    return report[section]["parts"][name][key].get<double>();
  };
  EXPECT_GT(part(many, "energy", "ray_store", "joules"), part(one, "energy", "ray_store", "joules"));
  EXPECT_GT(many["energy"]["joules"].get<double>(), one["energy"]["joules"].get<double>());
  EXPECT_GT(part(many, "area", "ray_stores", "size"), 5 * part(one, "area", "ray_stores", "size"));
  EXPECT_LT(part(many, "area", "ray_stores", "size"), 7 * part(one, "area", "ray_stores", "size"));
  // In a buffer of one hit each offer is one comparison, and a hit that is set aside pays its way back.
  const Json aside = reported(
      "collections.ready=1 collections.traversal=ordered rays.query.nearest=16 "
      "rays.query.buffer=1 rays.query.rounds=resume");
  const std::uint64_t waiting = aside["nearest"]["waiting_hits"], offered = aside["nearest"]["offered"];
  EXPECT_GT(waiting, 0u);
  EXPECT_EQ(aside["tests"]["buffer_steps"]["count"], offered + waiting);
  // The steps of one ray go one after another, so that more units and lanes are of no use to a ray that is alone.
  for (const std::string shape : {"independent", "ring"}) {
    const std::string alone = "topology.resources=1 topology.shape=" + shape +
                              " rays.slots_per_resource=1 collections.ready=1 rays.query.nearest=16 ";
    EXPECT_EQ(reported(alone + "testers.hit_buffer.units=8")["engine"]["cycles"],
              reported(alone + "testers.hit_buffer.units=1")["engine"]["cycles"])
        << shape;
  }
}

// A picture is that of rays with one hit each; all hits of its rays are compared with the oracle's.
TEST(Nearest, LeavesAPictureAsItIs) {
  Program program;
  program.write("rays.yaml",
                "scene: {builtin: spheres, triangles: 2000}\nimage: {width: 24, height: 16, samples: 1, max_depth: 3}\n"
                "verify: reference\nengine: {kind: cycle}\n");
  std::vector<Json> reports;
  for (const std::string sets :
       {"rays.query.nearest=0", "rays.query.nearest=5", "rays.query.nearest=5 topology.shape=independent",
        "rays.query.nearest=5 engine.kind=native",
        "rays.query.nearest=5 rays.query.buffer=2 rays.query.rounds=resume collections.traversal=ordered"}) {
    const Outcome outcome = run(program, sets);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    reports.push_back(report_of(program));
    EXPECT_EQ(reports.back()["digest"], reports[0]["digest"]) << sets;
    EXPECT_EQ(reports.back()["verify"]["mismatches"], 0);
    if (reports.size() > 1) {
      EXPECT_EQ(reports.back()["nearest"]["digest"], reports[1]["nearest"]["digest"]) << sets;
    }
  }
}

TEST(Nearest, RefusesWhatIsNotBuilt) {
  Program program;
  program.write("rays.yaml", "scene: {builtin: cornell}\nrays: {query: {nearest: 8}}\nengine: {kind: cycle}\n");
  const std::vector<std::pair<std::string, std::string>> refused{
      {"rays.query.nearest=65537", "rays.query.nearest: expected an integer from 0 to 65536"},
      {"rays.query.nearest=100 rays.query.buffer=65", "rays.query.buffer: expected"},
      {"rays.query.buffer=9", "rays.query.buffer: no ray has more hits than rays.query.nearest = 8"},
      {"rays.query.nearest=65",
       "rays.query.nearest: with fewer than rays.query.nearest = 65 a ray finds its hits in rounds; "
       "expected at most 64, or collections.traversal: ordered"},
      {"rays.query.buffer=2", "expected auto, or collections.traversal: ordered"},
      {"bundles.size=8", "bundles.size: rays of bundles share one bound"},
      {"primary=raster", "primary: rasterised camera rays have one hit each"},
      {"rays.query.rounds=resum", "did you mean 'resume'?"},
  };
  for (const auto& [sets, message] : refused) {
    const Outcome outcome = run(program, sets);
    EXPECT_EQ(outcome.status, 2) << sets;
    EXPECT_THAT(outcome.err, testing::HasSubstr(message)) << sets;
  }
}

}  // namespace
}  // namespace carousel::nearest_test

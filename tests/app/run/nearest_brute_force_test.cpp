// Rays that look for several nearest hits (rays.query.nearest) against every primitive tested in turn, on machines of
// all kinds, as a user asks for them.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/hits_of_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::nearest_test {
namespace {

using Json = nlohmann::json;

struct Machine {
  std::string sets;
  bool rounds;  ///< it has them
};

const std::vector<Machine>& machines() {
  static const std::vector<Machine> all{
      {"engine.kind=cycle topology.shape=independent topology.resources=2", true},
      {"engine.kind=cycle topology.resources=3 collections.traversal=ordered packets.rays=4", true},
      {"engine.kind=native engine.threads=2 topology.resources=3 collections.traversal=ordered", true},
      {"engine.kind=cycle topology.resources=3 collections.traversal=ordered bvh.builder=kd bvh.duplicates=2", true},
      {"engine.kind=cycle topology.resources=2 collections.traversal=ordered collections.key=block bvh.width=2", true},
      {"engine.kind=cycle engine.threads=2 topology.resources=5 bvh.storage=quantised", false},
      {"engine.kind=cycle topology.shape=bidirectional topology.resources=4 packets.shapes=single", false},
      {"engine.kind=cycle collections.traversal=treelet bvh.treelet_triangles=16 bvh.builder=spatial", false},
      {"engine.kind=cycle topology.resources=3 bvh.treelets.bytes=1024", false},
      {"engine.kind=cycle topology.shape=independent testers.simt.warp=8 testers.simt.idle_lanes=help", true},
      {"engine.kind=cycle topology.shape=independent testers.simt.warp=4 testers.simt.stack_entries=2", true},
      {"engine.kind=native collections.traversal=treelet bvh.treelet_triangles=64 engine.simd=ssse3", false},
      {"engine.kind=native collections.traversal=treelet engine.lanes=rays", false},
  };
  return all;
}

// Every machine writes the same file, which is that of every primitive tested in turn; machines with rounds in both
// ways and with several sizes of buffers.
TEST(Nearest, EqualsBruteForceOnEveryMachine) {
  const int count = scaled(120, 60);
  const std::size_t one_in = run_effort() > 2 ? 1 : 3;
  std::size_t turn = run_seed();
  for (const SceneOfHits& of : scenes()) {
    Program program;
    const scene::Scene& scene = of.scene;
    program.write("soup.gltf", soup().text());
    program.write("rays.csv", rays_through(scene.bounds(), count, run_seed()));
    program.write("rays.yaml", "scene: " + of.text + "\nworkload: {rays_from: rays.csv}\nverify: reference\n");
    const RayBatch rays = report::read_rays_csv(program.folder() / "rays.csv");
    const std::vector<std::vector<Hit>> all = every_hit(scene, rays);
    std::size_t most = 0;
    for (const std::vector<Hit>& hits : all) most = std::max(most, hits.size());
    ASSERT_GE(most, of.text.find("soup") == of.text.npos ? 1u : 14u) << of.text;
    for (const std::size_t k : {1, 2, 7, 16, 64}) {
      const std::string wanted = expected(program, rays, all, k);
      std::string digest, nearest_digest;
      for (const Machine& machine : machines()) {
        // All machines with all scenes and numbers would take a minute: they take turns.
        if (++turn % (machine.rounds ? 2 * one_in : 3 * one_in - 1) != 0) continue;
        std::vector<std::string> ways{""};
        if (machine.rounds && k > 1)
          ways = {fmt::format(" rays.query.buffer={} rays.query.rounds=restart", 1 + turn % (k - 1)),
                  fmt::format(" rays.query.buffer={} rays.query.rounds=resume", 1 + turn % (k - 1))};
        for (const std::string& way : ways) {
          const std::string sets = fmt::format("{} rays.query.nearest={}{}", machine.sets, k, way);
          const Outcome outcome = run(program, sets);
          ASSERT_EQ(outcome.status, 0) << sets << outcome.err;
          ASSERT_EQ(program.read("out/hits.csv"), wanted) << of.text << ": " << sets;
          const Json report = Json::parse(program.read("out/report.json"));
          EXPECT_EQ(report["verify"]["mismatches"], 0);
          if (digest.empty()) {
            digest = report["digest"]["hits"].get<std::string>();
            nearest_digest = report["nearest"]["digest"].get<std::string>();
          }
          EXPECT_EQ(report["digest"]["hits"], digest) << sets;
          EXPECT_EQ(report["nearest"]["digest"], nearest_digest) << sets;
        }
      }
    }
  }
  std::printf("%zu rays against every primitive\n", count * scenes().size());
}

// Every number of hits from 1 to 64, each with rays of its own, a machine and a way to go on: at the soak's effort of
// 20 they are more than 10^6 rays. Rays have more hits than any of them asks for.
TEST(Nearest, EqualsBruteForceForEveryNumber) {
  const int count = scaled(800, 60);
  const std::vector<SceneOfHits> all_scenes{
      {"{file: sheets.gltf}", sheets().load()}, {"{file: soup.gltf}", soup().load()}, scenes()[1], scenes()[2]};
  std::vector<std::size_t> numbers;
  for (std::size_t k = 1; k <= 64; ++k) numbers.push_back(k);
  std::size_t most = 0, compared = 0, turn = run_seed();
  Program program;
  program.write("soup.gltf", soup().text());
  program.write("sheets.gltf", sheets().text());
  for (const std::size_t k : some(numbers, 4)) {
    const SceneOfHits& of = all_scenes[turn % all_scenes.size()];
    program.write("rays.csv", rays_through(of.scene.bounds(), count, std::uint64_t{run_seed()} << 8 | k));
    program.write("rays.yaml", "scene: " + of.text + "\nworkload: {rays_from: rays.csv}\n");
    const RayBatch rays = report::read_rays_csv(program.folder() / "rays.csv");
    const std::vector<std::vector<Hit>> all = every_hit(of.scene, rays);
    for (const std::vector<Hit>& hits : all) most = std::max(most, hits.size());
    const Machine& machine = machines()[turn / all_scenes.size() % machines().size()];
    std::string sets = fmt::format("{} rays.query.nearest={}", machine.sets, k);
    if (machine.rounds && k > 1)
      sets += fmt::format(" rays.query.buffer={} rays.query.rounds={}", 1 + turn * 7 % (k - 1),
                          turn % 2 == 0 ? "resume" : "restart");
    const Outcome outcome = run(program, sets);
    ASSERT_EQ(outcome.status, 0) << sets << outcome.err;
    ASSERT_TRUE(program.read("out/hits.csv") == expected(program, rays, all, k)) << of.text << ": " << sets;
    compared += rays.size();
    ++turn;
  }
  EXPECT_GT(most, 64u);
  std::printf("%zu rays against every primitive\n", compared);
}

}  // namespace
}  // namespace carousel::nearest_test

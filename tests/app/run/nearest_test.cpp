// Rays that look for several nearest hits (rays.query.nearest), on both engines, as a user asks for them.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/csv/ray_csv.h"
#include "scene/builtin/builtin.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/random_runs.h"

namespace carousel::nearest_test {
namespace {

using Json = nlohmann::json;

/// Triangles that overlap each other, so that rays have a dozen hits and more.
scene::GltfBuilder soup() {
  constexpr int kTriangles = 1000;
  constexpr float kSize = 0.4f;
  std::mt19937 random(3);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  std::vector<float> positions;
  for (int i = 0; i < kTriangles; ++i) {
    const Vec3 middle{unit(), unit(), unit()};
    for (int corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis) positions.push_back(middle[axis] + kSize * (unit() - 0.5f));
  }
  scene::GltfBuilder out;
  out.mesh({{"POSITION", out.floats(positions, "VEC3", 3)}});
  return out;
}

struct SceneOfHits {
  std::string text;
  scene::Scene scene;
};

scene::Scene builtin(BuiltinScene which) {
  SceneConfig config;
  config.builtin = which;
  config.triangles = 300;
  config.instances = 60;
  config.procedural = which == BuiltinScene::kSpheres;
  return scene::make_builtin(config);
}

const std::vector<SceneOfHits>& scenes() {
  static const std::vector<SceneOfHits> all{
      {"{file: soup.gltf}", soup().load()},
      {"{builtin: instances, triangles: 300, instances: 60}", builtin(BuiltinScene::kInstances)},
      {"{builtin: spheres, triangles: 300, procedural: true}", builtin(BuiltinScene::kSpheres)},
      {"{builtin: terrain, triangles: 300}", builtin(BuiltinScene::kTerrain)}};
  return all;
}

/// Rays through the middle of a scene, along its ground in one of two, so that many have several hits; some begin
/// within or end early, and some are shadow rays.
std::string rays_through(const Aabb& bounds, int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto within = [&](double from, double to) { return from + (to - from) * (random() >> 32) / 4294967296.0; };
  std::string out = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < count; ++i) {
    double from[3], way[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double half = (axis == 1 && i % 2 == 0 ? 0.1 : 0.45) * bounds.extent()[axis];
      const double middle = bounds.centre()[axis];
      from[axis] = within(middle - half, middle + half);
      way[axis] = within(middle - half, middle + half) - from[axis];
      if (i % 4 != 0) from[axis] -= 3 * way[axis];
    }
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n", i, i % 11 == 0 ? "shadow" : "camera", from[0], from[1], from[2],
                       way[0], way[1], way[2], i % 7 == 0 ? "0.25,3.6" : "0,inf");
  }
  return out;
}

std::string csv_of(const std::filesystem::path& path, const std::vector<report::HitRow>& rows) {
  {
    AtomicFile file(path);
    report::write_hits_csv(file, rows, true);
    file.commit();
  }
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// By ray: all its hits, sorted, from every primitive tested in turn; of a shadow ray some hit.
std::vector<std::vector<Hit>> every_hit(const scene::Scene& scene, const RayBatch& rays) {
  std::vector<std::vector<Hit>> out;
  for (const RayRequest& ray : rays) {
    std::vector<Hit>& hits = out.emplace_back(accel::brute_force_all(scene, ray));
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
      return std::tuple(a.t, a.instance, a.primitive, a.u, a.v) < std::tuple(b.t, b.instance, b.primitive, b.u, b.v);
    });
  }
  return out;
}

/// hits.csv as it has to be with the `k` nearest hits of each.
std::string expected(const Program& program, const RayBatch& rays, const std::vector<std::vector<Hit>>& all,
                     std::size_t k) {
  std::vector<report::HitRow> rows;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    RayRequest ray = rays[i];
    const bool shadow = ray.tag.kind == RayKind::kShadow;
    if (!shadow) ray.tag.flags |= kRayAll;
    std::vector<Hit> hits(all[i].begin(), all[i].begin() + std::ptrdiff_t(std::min(shadow ? 1 : k, all[i].size())));
    if (hits.empty()) hits.emplace_back();
    for (std::uint32_t rank = 0; rank < hits.size(); ++rank)
      rows.push_back({ray.tag.path, rank, {ray.ray, hits[rank], ray.tag}});
  }
  return csv_of(program.folder() / "expected.csv", rows);
}

Outcome run(const Program& program, const std::string& sets) {
  std::vector<std::string> words{"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--no-html"};
  std::istringstream in(sets);
  for (std::string set; in >> set;) words.insert(words.end(), {"--set", set});
  return program.run(words);
}

Json report_of(const Program& program) {
  return Json::parse(program.read("out/report.json"));
}

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
      {"engine.kind=cycle topology.shape=independent testers.simt.warp=8 testers.simt.idle_lanes=help", false},
      {"engine.kind=native collections.traversal=treelet bvh.treelet_triangles=64 engine.simd=ssse3", false},
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
          const Json report = report_of(program);
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
  std::printf("%d rays of each scene against every primitive\n", count);
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
      {"rays.query.nearest=65", "rays.query.nearest: expected an integer from 0 to 64"},
      {"rays.query.buffer=9", "rays.query.buffer: no ray has more hits than rays.query.nearest = 8"},
      {"rays.query.buffer=2", "expected auto, or collections.traversal: ordered"},
      {"rays.query.buffer=2 topology.shape=independent testers.simt.warp=8", "testers.simt.warp: 0"},
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

// The hits that rays of a file look for, on both engines, as a user asks for them.
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
#include <unistd.h>

#include "core/types/enum_names.h"
#include "report/csv/ray_csv.h"
#include "scene/builtin/builtin.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/app/support/program.h"

namespace carousel::query_test {
namespace {

/// By row of hits.csv: kind, hit, and t.
std::vector<std::vector<std::string>> hit_rows(const std::string& csv) {
  std::istringstream in(csv);
  std::vector<std::vector<std::string>> out;
  std::vector<std::size_t> wanted;
  for (std::string line; std::getline(in, line);) {
    std::vector<std::string> cells;
    std::istringstream columns(line);
    for (std::string cell; std::getline(columns, cell, ',');) cells.push_back(cell);
    if (wanted.empty()) {
      for (const char* name : {"kind", "hit", "t"})
        wanted.push_back(static_cast<std::size_t>(std::find(cells.begin(), cells.end(), name) - cells.begin()));
      continue;
    }
    auto& row = out.emplace_back();
    for (const std::size_t column : wanted) row.push_back(column < cells.size() ? cells[column] : "");
  }
  return out;
}

TEST(Query, AnyFindsAHitWhereThereIsAClosestOne) {
  Program program;
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < 60; ++i)  // from before the box: half of them pass it by
    rays += fmt::format("{},camera,{},1,5,{},0,-1,0,inf\n", i, 0.02 * i - 0.6, 0.02 * (i - 30));
  program.write("rays.csv", rays);
  const auto hits = [&](const std::string& engine, const std::string& query) {
    const Outcome outcome = program.run({"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--set",
                                         "engine.kind=" + engine, "--set", "rays.query=" + query});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return hit_rows(program.read("out/hits.csv"));
  };
  program.write(
      "rays.yaml",
      "scene: {builtin: cornell}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 3}\nverify: reference\n");
  const auto closest = hits("cycle", "closest");
  ASSERT_EQ(closest.size(), 60u);
  for (const std::string engine : {"cycle", "native"}) {
    const auto any = hits(engine, "any");
    ASSERT_EQ(any.size(), closest.size());
    int found = 0;
    for (std::size_t i = 0; i < any.size(); ++i) {
      EXPECT_EQ(any[i][0], "shadow");
      EXPECT_EQ(any[i][1], closest[i][1]) << "ray " << i;
      found += any[i][1] == "1";
    }
    EXPECT_GT(found, 5);
    EXPECT_LT(found, 60);
  }
  program.write("picture.yaml", "scene: {builtin: cornell}\n");
  const Outcome refused = program.run({"run", "picture.yaml", "--set", "rays.query=any"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, testing::HasSubstr("expected closest, or workload: {rays_from: FILE}"));
}

/// Rays through the middle of a scene, from outside and from within; some end early.
std::string rays_through(const Aabb& bounds, int count) {
  std::mt19937 random(11);
  const auto within = [&](double from, double to) { return from + (to - from) * (random() / 4294967296.0); };
  std::string out = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < count; ++i) {
    double from[3], way[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double half = (axis == 1 && i % 2 == 0 ? 0.1 : 0.35) * bounds.extent()[axis];
      const double middle = bounds.centre()[axis];
      from[axis] = within(middle - half, middle + half);
      way[axis] = within(middle - half, middle + half) - from[axis];
      if (i % 3 != 0) from[axis] -= 3 * way[axis];
    }
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n", i, i % 7 == 0 ? "shadow" : "camera", from[0], from[1], from[2],
                       way[0], way[1], way[2], i % 5 == 0 ? "0.25,0.75" : "0,inf");
  }
  return out;
}

void write_hits(const std::filesystem::path& path, const std::vector<report::HitRow>& rows) {
  AtomicFile file(path);
  report::write_hits_csv(file, rows, true);
  file.commit();
}

/// hits.csv as it has to be, from every primitive tested in turn.
std::string every_hit(const scene::Scene& scene, const RayBatch& rays, std::size_t& most) {
  std::vector<report::HitRow> rows;
  for (const RayRequest& request : rays) {
    RayRequest ray = request;
    ray.tag.kind = RayKind::kCamera;
    ray.tag.flags |= kRayAll;
    std::vector<Hit> hits = accel::brute_force_all(scene, ray);
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
      return std::tuple(a.t, a.instance, a.primitive, a.u, a.v) < std::tuple(b.t, b.instance, b.primitive, b.u, b.v);
    });
    most = std::max(most, hits.size());
    if (hits.empty()) hits.emplace_back();
    for (const Hit& hit : hits)
      rows.push_back({ray.tag.path, static_cast<std::uint32_t>(&hit - hits.data()), {ray.ray, hit, ray.tag}});
  }
  const auto file = std::filesystem::temp_directory_path() / fmt::format("every_hit_{}.csv", ::getpid());
  write_hits(file, rows);
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  std::filesystem::remove(file);
  return text.str();
}

// A ray that passes through two walls of a closed surface: each flag takes one of them away.
TEST(Query, EachRayOfAFileHasItsFlags) {
  Program program;
  const std::vector<std::string> flags{"", "cull_back", "cull_front", "cull_back+cull_front", "force_opaque", ""};
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax,flags\n";
  SceneConfig config;
  config.builtin = BuiltinScene::kSpheres;
  config.triangles = 400;
  config.procedural = true;
  const scene::Scene scene = scene::make_builtin(config);
  const Vec3 centre = scene.bounds().centre(), extent = scene.bounds().extent();
  for (int i = 0; i < 180; ++i) {
    const int place = i / static_cast<int>(flags.size());
    rays += fmt::format("{},camera,{},{},{},{},-1,{},0,inf,{}\n", i, centre.x + extent.x * 0.01f * float(place - 15),
                        scene.bounds().hi.y + 1, centre.z, 0.01 * place, 0.003 * place,
                        flags[static_cast<std::size_t>(i) % flags.size()]);
  }
  program.write("rays.csv", rays);
  program.write("rays.yaml",
                "scene: {builtin: spheres, triangles: 400, procedural: true}\nworkload: {rays_from: rays.csv}\n"
                "topology: {resources: 3}\nverify: reference\n");
  std::vector<report::HitRow> expected;
  for (const RayRequest& ray : report::read_rays_csv(program.folder() / "rays.csv"))
    expected.push_back({ray.tag.path, 0, {ray.ray, accel::brute_force(scene, ray), ray.tag}});
  write_hits(program.folder() / "expected.csv", expected);
  int fewer = 0, none = 0;
  for (std::size_t i = 0; i < expected.size(); i += flags.size()) {
    const auto t = [&](std::size_t k) { return expected[i + k].result.hit.t; };
    fewer += t(2) > t(0) && t(1) == t(0);
    none += expected[i].result.hit.valid() && !expected[i + 3].result.hit.valid();
    EXPECT_EQ(t(4), t(0));
  }
  EXPECT_GT(fewer, 3);
  EXPECT_GT(none, 3);
  for (const std::string engine : {"cycle", "native"}) {
    const Outcome outcome = program.run(
        {"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--set", "engine.kind=" + engine});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(program.read("out/hits.csv"), program.read("expected.csv")) << engine;
  }
}

struct SceneOfAllHits {
  std::string builtin;
  std::string text;
};

// Every machine writes the same file, which is that of every primitive tested in turn.
TEST(Query, AllFindsEveryHitInOrder) {
  const std::vector<std::string> machines{
      "engine.kind=native engine.threads=2 topology.resources=3",
      "engine.kind=native collections.traversal=ordered",
      "engine.kind=native collections.traversal=treelet bvh.treelet_triangles=16 bundles.size=8",
      "engine.kind=cycle topology.resources=5 bvh.builder=kd bvh.duplicates=2",
      "engine.kind=cycle collections.traversal=ordered packets.rays=4 bvh.width=2",
      "engine.kind=cycle collections.traversal=treelet bvh.storage=quantised bvh.builder=spatial",
      "engine.kind=cycle topology.shape=independent bvh.builder=octree bvh.duplicates=3",
      "engine.kind=cycle engine.threads=2 topology.resources=4 packets.shapes=single testers.any_hit=shader",
  };
  for (const auto& [builtin, text] :
       {SceneOfAllHits{"instances", "{builtin: instances, triangles: 300, instances: 12}"},
        SceneOfAllHits{"spheres", "{builtin: spheres, triangles: 400, procedural: true}"}}) {
    Program program;
    SceneConfig config;
    config.builtin = enum_value<BuiltinScene>(builtin);
    config.triangles = builtin == "spheres" ? 400 : 300;
    config.instances = 12;
    config.procedural = builtin == "spheres";
    const scene::Scene scene = scene::make_builtin(config);
    program.write("rays.csv", rays_through(scene.bounds(), 300));
    std::size_t most = 0;
    const std::string expected = every_hit(scene, report::read_rays_csv(program.folder() / "rays.csv"), most);
    ASSERT_GT(most, 1u) << builtin;
    program.write("rays.yaml", "scene: " + text + "\nworkload: {rays_from: rays.csv}\nrays: {query: all}\n");
    for (const std::string& machine : machines) {
      std::vector<std::string> words{"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet"};
      std::istringstream sets(machine);
      for (std::string set; sets >> set;) words.insert(words.end(), {"--set", set});
      const Outcome outcome = program.run(words);
      ASSERT_EQ(outcome.status, 0) << machine << outcome.err;
      EXPECT_EQ(program.read("out/hits.csv"), expected) << builtin << ": " << machine;
    }
    for (const std::string engine : {"cycle", "native"}) {
      const std::string limit = fmt::format("rays.hits_per_ray={}", most - 1);
      const Outcome outcome = program.run({"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--set",
                                           "engine.kind=" + engine, "--set", limit});
      EXPECT_EQ(outcome.status, 2);
      EXPECT_THAT(outcome.err, testing::HasSubstr(fmt::format(
                                   "rays.hits_per_ray: a ray of the file has more than {} hits", most - 1)));
    }
  }
}

}  // namespace
}  // namespace carousel::query_test

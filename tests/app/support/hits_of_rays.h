#pragma once

// Scenes in which rays have many hits, rays through them, and the files that a run has to write of them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "report/csv/ray_csv.h"
#include "scene/builtin/builtin.h"
#include "tests/accel/traverse/brute_force.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::nearest_test {
/// Triangles that overlap each other, so that rays have a dozen hits and more.
inline scene::GltfBuilder soup() {
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

/// 200 sheets, each a triangle around the y axis, at heights and slopes of their own: steep rays have more than 64
/// hits, some of which lie close together.
inline scene::GltfBuilder sheets() {
  constexpr int kSheets = 200;
  constexpr float kCircle = 2 * std::numbers::pi_v<float>;
  std::mt19937 random(4);
  const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24f; };
  std::vector<float> positions;
  for (int i = 0; i < kSheets; ++i) {
    const float turn = kCircle * unit(), height = 20 * unit();
    for (int corner = 0; corner < 3; ++corner) {
      const float angle = turn + kCircle / 3 * static_cast<float>(corner), radius = 1 + unit();
      positions.insert(positions.end(), {radius * std::cos(angle), height + 0.2f * unit(), radius * std::sin(angle)});
    }
  }
  scene::GltfBuilder out;
  out.mesh({{"POSITION", out.floats(positions, "VEC3", 3)}});
  return out;
}

struct SceneOfHits {
  std::string text;
  scene::Scene scene;
};

inline scene::Scene builtin(BuiltinScene which) {
  SceneConfig config;
  config.builtin = which;
  config.triangles = 300;
  config.instances = 60;
  config.procedural = which == BuiltinScene::kSpheres;
  return scene::make_builtin(config);
}

inline const std::vector<SceneOfHits>& scenes() {
  static const std::vector<SceneOfHits> all{
      {"{file: soup.gltf}", soup().load()},
      {"{builtin: instances, triangles: 300, instances: 60}", builtin(BuiltinScene::kInstances)},
      {"{builtin: spheres, triangles: 300, procedural: true}", builtin(BuiltinScene::kSpheres)},
      {"{builtin: terrain, triangles: 300}", builtin(BuiltinScene::kTerrain)}};
  return all;
}

/// Rays through the middle of a scene, along its ground in one of two, so that many have several hits; some begin
/// within or end early, and some are shadow rays.
inline std::string rays_through(const Aabb& bounds, int count, std::uint64_t seed) {
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

inline std::string csv_of(const std::filesystem::path& path, const std::vector<report::HitRow>& rows) {
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
inline std::vector<std::vector<Hit>> every_hit(const scene::Scene& scene, const RayBatch& rays) {
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
inline std::string expected(const Program& program, const RayBatch& rays, const std::vector<std::vector<Hit>>& all,
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

inline Outcome run(const Program& program, const std::string& sets) {
  std::vector<std::string> words{"run", "rays.yaml", "--hits", "--out", "out", "--force", "--quiet", "--no-html"};
  std::istringstream in(sets);
  for (std::string set; in >> set;) words.insert(words.end(), {"--set", set});
  return program.run(words);
}

}  // namespace carousel::nearest_test

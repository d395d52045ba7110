// The hard cases of a ray and triangles at every level, traced through a structure with conservative boxes (and double
// ones where boxes matter), judged by big integers.
#include <cmath>
#include <iostream>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "accel/certificate/triangle_oracle.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/primitive/adversarial_triangles.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

AccuracyConfig level(TriangleLevel triangle, BoxLevel box = BoxLevel::kConservative) {
  AccuracyConfig accuracy;
  accuracy.triangle = triangle;
  accuracy.box = box;
  return accuracy;
}
const std::vector<AccuracyConfig>& safe_levels() {
  static const std::vector<AccuracyConfig> levels{level(TriangleLevel::kWatertight),
                                                  level(TriangleLevel::kDouble),
                                                  level(TriangleLevel::kExact),
                                                  level(TriangleLevel::kWatertight, BoxLevel::kDouble),
                                                  level(TriangleLevel::kDouble, BoxLevel::kDouble),
                                                  level(TriangleLevel::kExact, BoxLevel::kDouble)};
  return levels;
}
Accel at_level(const scene::Scene& scene, const AccuracyConfig& accuracy) {
  return build_sequential(scene, 8, 4, accuracy);
}

/// A closed surface, and a place inside of it with room around.
struct ClosedMesh {
  std::string name;
  scene::Scene scene;
  Vec3 centre, room;
};

std::vector<ClosedMesh> closed_meshes() {
  std::vector<ClosedMesh> meshes;
  const auto add = [&](const std::string& name, const Vec3& centre, const Vec3& scale) {
    scene::Scene scene = icosphere_scene(3);
    for (Vec3& p : scene.meshes[0].positions) p = centre + p * scale;
    meshes.push_back({name, std::move(scene), centre, 0.4f * scale});
  };
  add("unit", Vec3{0}, Vec3{1});
  add("flattened 1000 times", Vec3{0}, {1, 1e-3f, 1});
  add("1e3 away", {1e3f, -1e3f, 5e2f}, Vec3{1});
  add("1e5 away", {1e5f, 1e5f, -1e5f}, Vec3{1});
  add("flattened, 1e3 away", {1e3f, 0, 1e3f}, {1, 1e-2f, 1});
  return meshes;
}

/// From inside, at every edge and every corner in turn, and at places along the edges.
RayBatch rays_at_edges(const ClosedMesh& mesh, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const scene::Mesh& m = mesh.scene.meshes[0];
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t corner = i % m.indices.size(), next = corner % 3 == 2 ? corner - 2 : corner + 1;
    const Vec3 a = m.positions[m.indices[corner]], b = m.positions[m.indices[next]];
    const Vec3 from = i % 5 ? mesh.centre + random.in_box(-mesh.room, mesh.room) * 0.9f : mesh.centre;
    const std::uint32_t how = random.below(4);
    const Vec3 at = how == 0 ? a : how == 1 ? 0.5f * (a + b) : a + random.uniform() * (b - a);
    rays.push_back(ray_to(from, nudged(at - from, how == 3 ? 1 : 0, random)));
  }
  return rays;
}

std::size_t misses(const Accel& accel, const RayBatch& rays) {
  std::size_t misses = 0;
  for (const RayResult& r : trace(accel, rays)) misses += !r.hit.valid();
  return misses;
}

TEST(HardTriangle, ClosedSpheresLeakNothing) {
  const auto count = static_cast<std::size_t>(scaled(20'000));  // a mesh
  std::vector<std::size_t> leaks(safe_levels().size() + 1);
  for (const ClosedMesh& mesh : closed_meshes()) {
    const RayBatch rays = rays_at_edges(mesh, count, 60 + 100 * std::uint64_t{run_seed()});
    for (std::size_t l = 0; l < safe_levels().size(); ++l) {
      const std::size_t missed = misses(at_level(mesh.scene, safe_levels()[l]), rays);
      EXPECT_EQ(missed, 0u) << mesh.name << " " << text(safe_levels()[l]) << " CAROUSEL_SEED=" << run_seed();
      leaks[l] += missed;
    }
    leaks.back() += misses(at_level(mesh.scene, level(TriangleLevel::kFast)), rays);
  }
  for (std::size_t l = 0; l < safe_levels().size(); ++l)
    std::cout << text(safe_levels()[l]) << ": " << leaks[l] << ", ";
  std::cout << "fast and conservative: " << leaks.back() << " leaks in " << count * closed_meshes().size() << " rays\n";
  EXPECT_GT(leaks.back(), count / 20);  // or the rays were not hard
}

TEST(HardTriangle, SpheresOfAnySizeLeakNothing) {
  for (const float scale :
       {1e-30f, 1e-25f, 1e-22f, 1e-20f, 1e-19f, 1e-15f, 1e-6f, 1e6f, 1e9f, 1e12f, 1e18f, 1e19f, 1e20f, 1e25f, 1e36f}) {
    ClosedMesh mesh = closed_meshes()[0];
    for (Vec3& p : mesh.scene.meshes[0].positions) p = p * scale;
    mesh.room = mesh.room * scale;
    RayBatch rays = rays_at_edges(mesh, 1000, 61);
    for (std::size_t i = 0; i < rays.size(); i += 2)  // give every second ray length 1, as a camera does
      rays[i].ray.direction = Vec3(glm::normalize(DVec3(rays[i].ray.direction)));
    for (const AccuracyConfig& accuracy : safe_levels())
      EXPECT_EQ(misses(at_level(mesh.scene, accuracy), rays), 0u) << scale << " " << text(accuracy);
  }
}

// Small things in a scene of 1e9 units: what is aimed at is met, at the level's own precision.
TEST(HardTriangle, SceneOfABillionUnits) {
  Random random(62);
  scene::Scene scene = empty_scene();
  std::vector<Vec3> corners;
  for (int i = 0; i < 200; ++i) {
    const Vec3 at = random.in_box(Vec3{-1e9f}, Vec3{1e9f});
    for (int k = 0; k < 3; ++k) corners.push_back(at + random.in_box(Vec3{-1e6f}, Vec3{1e6f}));
  }
  add_instance(scene, add_mesh(scene, soup(corners)));
  RayBatch rays;
  for (std::size_t i = 0; i < 20000; ++i) {
    const Vec3* p = &corners[3 * (i % 200)];
    const Vec3 from = random.in_box(Vec3{-2e9f}, Vec3{2e9f});
    rays.push_back(ray_to(from, (p[0] * 0.25f + p[1] * 0.25f + p[2] * 0.5f) - from));
  }
  for (const AccuracyConfig& accuracy : safe_levels()) {
    std::size_t missed = 0;
    const HitBatch hits = trace(at_level(scene, accuracy), rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3* p = &corners[3 * (i % 200)];
      if (hits[i].hit.valid()) continue;
      // Seen edge-on the rounded aim may be a miss.
      missed += TriangleOracle(rays[i].ray, {p[0], p[1], p[2]}).hit();
    }
    EXPECT_LE(missed, accuracy.triangle == TriangleLevel::kExact ? 0u : 2u) << text(accuracy);
  }
}

TEST(HardTriangle, SliversAMillionTimesAsLongAsWide) {
  Random random(63);
  std::size_t exact_hits = 0, missed[4] = {}, invented[4] = {};
  constexpr std::size_t kSlivers = 40, kRaysEach = 500;
  for (std::size_t s = 0; s < kSlivers; ++s) {
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), along = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 across =
        1e-6f * glm::length(along) * glm::normalize(glm::cross(along, random.in_box(Vec3{-1}, Vec3{1})));
    const std::array<Vec3, 3> p{a, a + along, a + 0.5f * along + across};
    RayBatch rays;
    for (std::size_t i = 0; i < kRaysEach; ++i) {
      const Vec3 from = random.in_box(Vec3{-3}, Vec3{3});
      rays.push_back(
          ray_to(from, nudged(p[0] + random.uniform() * along + random.uniform() * across - from, 1, random)));
    }
    const scene::Scene scene = scene_of(soup({p[0], p[1], p[2]}));
    for (const auto& triangle : kEnumNames<TriangleLevel>) {
      const HitBatch hits = trace(at_level(scene, level(triangle.value)), rays);
      for (const RayResult& r : hits) {
        const TriangleOracle oracle(r.ray, p);
        const bool in_front = oracle.hit() && oracle.compare_t(0) >= 0;
        missed[static_cast<int>(triangle.value)] += in_front && !r.hit.valid();
        invented[static_cast<int>(triangle.value)] += !in_front && r.hit.valid();
        exact_hits += in_front && triangle.value == TriangleLevel::kExact;
      }
    }
  }
  std::cout << exact_hits << " hits; ";
  for (const auto& l : kEnumNames<TriangleLevel>)
    std::cout << l.name << ": " << missed[static_cast<int>(l.value)] << " missed, "
              << invented[static_cast<int>(l.value)] << " invented; ";
  std::cout << "\n";
  EXPECT_GT(exact_hits, 2000u);
  EXPECT_EQ(missed[static_cast<int>(TriangleLevel::kExact)], 0u);
  EXPECT_EQ(invented[static_cast<int>(TriangleLevel::kExact)], 0u);
  EXPECT_LE(missed[static_cast<int>(TriangleLevel::kDouble)], missed[static_cast<int>(TriangleLevel::kWatertight)]);
  EXPECT_GT(missed[static_cast<int>(TriangleLevel::kFast)], 0u);
}

TEST(HardTriangle, WithoutAreaIsMissed) {
  Random random(64);
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = grid_point(random, 20), step = grid_point(random, 3), from = 3.0f * grid_point(random, 20);
    const std::vector<Vec3> corners{a, a, a, a, a + step, a + step, a, a + step, a, a, a + step, a + 2.0f * step};
    const scene::Scene scene = scene_of(soup(corners));
    for (const auto& triangle : kEnumNames<TriangleLevel>) {
      const Accel accel = at_level(scene, level(triangle.value));
      for (const Vec3& corner : corners) {
        if (corner == from) continue;
        const Hit hit = trace_one(accel, ray_to(from, corner - from));
        // Three corners on a line need exact arithmetic to be known for what they are.
        EXPECT_FALSE(hit.valid() && (hit.primitive < 3 || triangle.value == TriangleLevel::kExact)) << triangle.name;
      }
    }
  }
}

// Others reported this kind of fault: tinybvh 156.
TEST(HardTriangle, RaysWithNanOrInfinityAreRejected) {
  const scene::Scene scene = icosphere_scene(2);
  RayBatch rays;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      RayRequest r = ray_to({0, 0, 0.1f}, {0.1f, 0.2f, 1});
      r.ray.origin[axis] = bad;
      rays.push_back(r);
      r = ray_to({0, 0, 0.1f}, {0.1f, 0.2f, 1});
      r.ray.direction[axis] = bad;
      rays.push_back(r);
    }
    rays.push_back(ray_to({0, 0, 0}, {0, 0, 1}, bad == kInfinity ? -kInfinity : bad));
  }
  rays.push_back(ray_to({0, 0, 0}, {0, 0, 1}, 0, std::numeric_limits<float>::quiet_NaN()));
  rays.push_back(ray_to({0, 0, 0}, {0, 0, 0}));
  rays.push_back(ray_to({0, 0, 0}, {0, 0, 1}, 3, 2));
  for (const AccuracyConfig& accuracy : triangle_and_box_levels())
    EXPECT_EQ(misses(at_level(scene, accuracy), rays), rays.size()) << text(accuracy);
}

TEST(HardTriangle, HitExactlyAtTminAndTmaxAndOneUlpOff) {
  // At t = 2 with no rounding on the way, whatever the formula.
  const scene::Scene scene = scene_of(soup({{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}));
  const float two = 2, up = std::nextafter(two, 3.0f), down = std::nextafter(two, 1.0f);
  for (const AccuracyConfig& accuracy : triangle_and_box_levels()) {
    const Accel accel = at_level(scene, accuracy);
    const auto hit = [&](float tmin, float tmax) {
      return trace_one(accel, ray_to({0, 0, -2}, {0, 0, 1}, tmin, tmax));
    };
    for (const Hit& h : {hit(two, kInfinity), hit(0, two), hit(two, two), hit(down, up)}) {
      EXPECT_TRUE(h.valid()) << text(accuracy);
      EXPECT_EQ(h.t, two) << text(accuracy);
    }
    EXPECT_FALSE(hit(up, kInfinity).valid()) << text(accuracy);
    EXPECT_FALSE(hit(0, down).valid()) << text(accuracy);
  }
}

TEST(HardTriangle, TwoSharingAnEdgeSeenEdgeOn) {
  Random random(65);
  std::size_t hits = 0, missed[4] = {};
  const int cases = std::min(20000, scaled(8000));
  for (int i = 0; i < cases; ++i) {
    // A ray in both planes or nearly so, through the middle of the edge that they share.
    const Vec3 a = random.in_box(Vec3{-1}, Vec3{1}), b = random.in_box(Vec3{-1}, Vec3{1}),
               left = random.in_box(Vec3{-1}, Vec3{1});
    const Vec3 right = a + b - left, aim = 0.5f * (a + b);  // a parallelogram
    const Vec3 from =
        nudged(aim + random.uniform(0.5f, 3) * (right - left) + random.uniform(-1, 1) * (b - a), 2, random);
    const RayRequest request = ray_to(from, nudged(aim - from, i % 2, random));
    const bool exact =
        TriangleOracle(request.ray, {a, b, left}).hit() || TriangleOracle(request.ray, {b, a, right}).hit();
    hits += exact;
    const scene::Scene scene = scene_of(soup({a, b, left, b, a, right}));
    for (const auto& triangle : kEnumNames<TriangleLevel>) {
      const bool ours = trace_one(at_level(scene, level(triangle.value)), request).valid();
      missed[static_cast<int>(triangle.value)] += exact && !ours;
      if (triangle.value == TriangleLevel::kExact) {
        ASSERT_EQ(ours, exact) << i;
      }
    }
  }
  std::cout << hits << " of " << cases << " hit; ";
  for (const auto& l : kEnumNames<TriangleLevel>)
    std::cout << l.name << ": " << missed[static_cast<int>(l.value)] << " missed; ";
  std::cout << "\n";
  EXPECT_GT(hits, 100u);
}

// Triangles in a plane, and rays in it but for a denormal: their edge values are below all floats. Where the ray's line
// passes a triangle at a distance, the watertight level called it hit.
TEST(HardTriangle, DenormalDirectionsInventNoHits) {
  Random random(run_seed() + 32);
  constexpr float kLeast = std::numeric_limits<float>::denorm_min();
  const auto in_plane = [&] { return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 3); };
  std::size_t passes = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = in_plane(), b = in_plane(), c = in_plane(), from = 2.0f * in_plane() - Vec3(0, 0, 3);
    const Vec3 along = in_plane() - from;
    const Vec3 direction(along.x, along.y,
                         (random.below(2) ? kLeast : -kLeast) * static_cast<float>(1 + random.below(3)));
    double least = INFINITY, most = -INFINITY;  // distances of the corners from the line, one side positive
    for (const Vec3& corner : {a, b, c}) {
      const DVec3 to(corner - from), d(along);
      const double beside = (to.x * d.y - to.y * d.x) / std::hypot(d.x, d.y);
      least = std::min(least, beside), most = std::max(most, beside);
    }
    if (least < 1e-3 && most > -1e-3) continue;
    ++passes;
    for (const AccuracyConfig& accuracy : safe_levels())
      ASSERT_FALSE(trace_one(at_level(scene_of(soup({a, b, c})), accuracy), ray_to(from, direction)).valid()) << i;
  }
  EXPECT_GT(passes, 2000u);
}

}  // namespace
}  // namespace carousel::accel

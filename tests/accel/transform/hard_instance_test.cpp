// Instances that are hard to hit where they are, at every level of transform, against exact hits.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "accel/traverse/exact_reference.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/structure/placements.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/publish.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

Accel build_at(const scene::Scene& scene, TransformLevel level) {
  AccuracyConfig accuracy;
  accuracy.transform = level;
  return build(scene, BvhConfig{}, *make_sequential_executor(), accuracy);
}

/// Rays from a few units away at points inside of triangles, at least a thousandth away from the edges.
RayBatch rays_at_insides(const scene::Scene& scene, int count, std::uint32_t seed) {
  Random random(seed);
  RayBatch rays;
  for (int i = 0; i < count; ++i) {
    const scene::Instance& instance = scene.instances[random.below(static_cast<std::uint32_t>(scene.instances.size()))];
    const scene::Mesh& mesh = scene.meshes[instance.mesh.value];
    const std::uint32_t k = 3 * random.below(static_cast<std::uint32_t>(mesh.triangle_count()));
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    u = 0.001 + 0.997 * u, v = 0.001 + 0.997 * v;
    const DVec3 p[3] = {DVec3(mesh.positions[mesh.indices[k]]), DVec3(mesh.positions[mesh.indices[k + 1]]),
                        DVec3(mesh.positions[mesh.indices[k + 2]])};
    const scene::Affine& m = instance.world_from_model;
    const DVec3 at = DMat3(m.linear) * ((1 - u - v) * p[0] + u * p[1] + v * p[2]) + DVec3(m.translation);
    // Not grazing: there the triangle's own distance along the ray is what rounding moves.
    const DVec3 normal = glm::cross(DMat3(m.linear) * (p[1] - p[0]), DMat3(m.linear) * (p[2] - p[0]));
    DVec3 way;
    do {
      way = random_direction(random);
    } while (std::fabs(glm::dot(way, normal)) < 0.1 * glm::length(normal));
    const Vec3 from(at + 5.0 * way);
    rays.push_back(ray_to(from, Vec3(at - DVec3(from))));
  }
  return rays;
}

/// The answers of a level for rays that hit exactly.
struct Compared {
  std::size_t exact_hits = 0, lost = 0, other_t = 0;
};

Compared compare(const scene::Scene& scene, TransformLevel level, const RayBatch& rays) {
  const Accel accel = build_at(scene, level);
  const ExactReference reference(scene);
  Compared out;
  for (const RayResult& r : trace(accel, rays)) {
    const ExactHit exact = reference.closest(r.ray);
    if (!exact.hit.valid()) continue;
    ++out.exact_hits;
    out.lost += !r.hit.valid();
    out.other_t += r.hit.valid() && std::fabs(r.hit.t - exact.t) > 1e-4 * exact.t;
  }
  return out;
}

TEST(HardInstance, UnitTriangleAMillionAwayIsNotLost) {
  const int rays = scaled(20000);
  const scene::Scene scene =
      scene_of(soup({{-0.5f, -0.3f, 0}, {0.5f, -0.3f, 0.1f}, {0, 0.6f, 0}}),
               rotate_scale_translate({1, 2, 3}, 40, {1, 1, 1}, 1e6 * glm::normalize(DVec3{0.6, -0.55, 0.58})));
  const RayBatch batch = rays_at_insides(scene, rays, run_seed() + 530);
  std::string table = fmt::format(
      "\nUnit triangle a million units away, {} rays aimed at it from 5 units, seed {}:\n\n| level "
      "| lost | t off by more than 1e-4 |\n|---|---:|---:|\n",
      rays, run_seed() + 530);
  for (const auto& level : kEnumNames<TransformLevel>) {
    const Compared aimed = compare(scene, level.value, batch);
    table += fmt::format("| {} | {} | {} |\n", level.name, aimed.lost, aimed.other_t);
    EXPECT_GT(aimed.exact_hits, static_cast<std::size_t>(rays) * 9 / 10);
    if (level.value == TransformLevel::kInverseMatrix)
      EXPECT_GT(aimed.lost, aimed.exact_hits / 10);
    else
      EXPECT_EQ(aimed.lost + aimed.other_t, 0u) << level.name;
  }
  publish(table);
}

TEST(HardInstance, MirroredInstancesAreHitWhereTheyAre) {
  scene::Scene scene = icosphere_scene(1);
  for (const auto& level : kEnumNames<TransformLevel>) {
    for (const DVec3 scale : {DVec3{-1, 1, 1}, DVec3{2, -0.5, 1}, DVec3{-1, -1, -1}}) {
      scene.instances[0].world_from_model = rotate_scale_translate({1, -2, 0.5}, 77, scale, {3, 4, 5});
      const Compared found = compare(scene, level.value, rays_at_insides(scene, 1500, run_seed() + 540));
      EXPECT_EQ(found.exact_hits, 1500u);
      EXPECT_EQ(found.lost + found.other_t, 0u) << level.name;
    }
  }
}

// A flattened instance is traced as world-space triangles at every level: they lie in its plane to a rounding.
// Others reported this kind of fault: three-mesh-bvh 794, glTF 985.
TEST(HardInstance, SingularInstancesAreBakedAndHit) {
  scene::Scene scene = icosphere_scene(1);
  scene.instances[0].world_from_model = {Mat3(DMat3(1, 0, 0, 0, 1, 0, 0, 0, 0) * rotation({1, 1, 0}, 30)),
                                         {10, 20, 30}};
  for (const auto& level : kEnumNames<TransformLevel>) {
    const Accel accel = build_at(scene, level.value);
    EXPECT_EQ(accel.baked_instances, 1u);
    const ExactReference reference(scene);
    std::size_t hits = 0;
    Random random(run_seed() + 550);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 from = Vec3{10, 20, 33} + random.in_box(Vec3{-2}, Vec3{2}),
                 at = Vec3{10, 20, 30} + random.in_box({-0.6f, -0.6f, 0}, {0.6f, 0.6f, 0});
      const RayRequest ray = ray_to(from, at - from);
      const ExactHit exact = reference.closest(ray.ray);
      const Hit hit = trace_one(accel, ray);
      ASSERT_TRUE(exact.hit.valid());
      EXPECT_TRUE(exact.tie) << i;  // front and back of the ball have been laid onto each other
      ASSERT_TRUE(hit.valid());
      EXPECT_NEAR(hit.t, exact.t, 1e-5 * exact.t);
      ++hits;
    }
    EXPECT_EQ(hits, 2000u);
  }
}

TEST(HardInstance, CoincidentInstancesGiveTheFirst) {
  scene::Scene scene = icosphere_scene(1);
  scene.instances[0].world_from_model = patent_placements()[0];
  for (int i = 0; i < 3; ++i) add_instance(scene, 0, patent_placements()[0]);
  for (const auto& level : kEnumNames<TransformLevel>) {
    const Accel accel = build_at(scene, level.value);
    const ExactReference reference(scene);
    std::size_t hits = 0;
    for (const RayResult& r : trace(accel, whole_rays(scene, 600, run_seed() + 560))) {
      const ExactHit exact = reference.closest(r.ray);
      if (exact.hit.valid()) {
        EXPECT_EQ(exact.hit.instance, 0u);
        EXPECT_TRUE(exact.tie);
      }
      if (!r.hit.valid()) continue;
      ++hits;
      EXPECT_EQ(r.hit.instance, 0u) << level.name;
    }
    EXPECT_GT(hits, 50u);
  }
}

// A floor of tiles, each an instance of one square: a ray at a seam that hits exactly must find one tile or the other.
// Turned tiles have rounded translations, so some exact gaps and overlaps; those do not count.
TEST(HardInstance, AbuttingInstancesLeaveNoGap) {
  const int rays = scaled(6000);
  std::string table = fmt::format(
      "\nA floor of 8 by 8 square instances, {} rays aimed at seams, seed {}; leaks where the exact ray "
      "hits:\n\n| level | upright | turned | upright, 1e5 away | turned, 1e5 away |\n|---|---:|---:|"
      "---:|---:|\n",
      rays, run_seed() + 570);
  for (const auto& level : kEnumNames<TransformLevel>) {
    table += fmt::format("| {} |", level.name);
    for (const double distance : {0.0, 1e5}) {
      for (const double degrees : {0.0, 40.0}) {
        scene::Scene scene = empty_scene();
        scene::Mesh square;
        square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        square.indices = {0, 1, 2, 0, 2, 3};
        const std::uint32_t mesh = add_mesh(scene, square);
        const DMat3 turn = degrees == 0 ? DMat3(1.0) : rotation({1, 2, 3}, degrees);
        const DVec3 corner(distance);
        for (int x = 0; x < 8; ++x)
          for (int y = 0; y < 8; ++y) add_instance(scene, mesh, {Mat3(turn), Vec3(corner + turn * DVec3(x, y, 0))});
        Random random(run_seed() + 570);
        RayBatch batch;
        for (int i = 0; i < rays; ++i) {
          DVec3 at(0.0);
          const int seam = static_cast<int>(random.below(2));
          at[seam] = 1 + random.below(7);
          at[1 - seam] = random.uniform(0.5f, 7.5f);
          const DVec3 above = at + DVec3{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(1, 4)};
          const Vec3 from(corner + turn * above);
          batch.push_back(ray_to(from, Vec3(corner + turn * at - DVec3(from))));
        }
        const Compared found = compare(scene, level.value, batch);
        table += fmt::format(" {} of {} |", found.lost, found.exact_hits);
        if (degrees == 0) {
          EXPECT_EQ(found.lost, 0u) << level.name << " at " << distance;
        }
        // Fewer than pass through gaps that rounding the translations has opened by itself.
        if (degrees != 0 && level.value != TransformLevel::kInverseMatrix) {
          EXPECT_LT(found.lost, (batch.size() - found.exact_hits) / 3) << level.name << " at " << distance;
        }
      }
    }
    table += "\n";
  }
  publish(table);
}

}  // namespace
}  // namespace carousel::accel

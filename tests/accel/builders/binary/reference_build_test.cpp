// Structures that hold a triangle several times (`bvh.builder: spatial | kd | octree`): the answers of every triangle
// tested in turn, and of the structure that holds each once, for any ray.
#include "accel/builders/binary/reference_build.h"

#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

constexpr auto kCutting =
    std::to_array({BvhConfig::Builder::kSpatial, BvhConfig::Builder::kOctree, BvhConfig::Builder::kKd});

BvhConfig cutting(BvhConfig::Builder builder, double duplicates = 2) {
  BvhConfig config;
  config.builder = builder;
  config.duplicates = duplicates;
  return config;
}

Accel build_cut(const scene::Scene& scene, const BvhConfig& config, const AccuracyConfig& accuracy = {}) {
  return build(scene, config, *make_sequential_executor(), accuracy);
}

/// Long triangles in all directions, and small ones among them: what planes in space are for. Coordinates of a coarse
/// grid make many of them flat, and put planes on vertices.
scene::Scene long_and_small(std::uint32_t triangles, std::uint64_t seed, bool grid) {
  Random random(seed);
  std::vector<Vec3> corners;
  const auto coordinate = [&](float reach) {
    const float x = (random.uniform() * 2 - 1) * reach;
    return grid ? std::round(x * 8) / 8 : x;
  };
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const float reach = i % 3 == 0 ? 4.0f : 0.3f;
    const Vec3 centre{coordinate(4), coordinate(4), coordinate(4)};
    for (int k = 0; k < 3; ++k)
      corners.push_back(centre + Vec3{coordinate(reach), coordinate(reach), coordinate(reach)});
  }
  scene::Scene scene = empty_scene();
  add_instance(scene, add_mesh(scene, soup(corners)));
  return scene;
}

/// Rays along planes that boxes are cut at, along triangles, through their vertices and edges, and from far away.
RayBatch grazing_rays(const scene::Scene& scene, const Accel& accel, std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  const auto& p = scene.meshes[0].positions;
  const Aabb bounds = scene.bounds();
  RayBatch out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t triangle = random.below(static_cast<std::uint32_t>(p.size() / 3));
    const auto on_triangle = [&] {
      const float a = random.below(2) != 0 ? random.uniform() : 0.0f,
                  b = random.below(2) != 0 ? random.uniform() : 0.0f;
      return p[3 * triangle] * (1 - a) + (p[3 * triangle + 1] * (1 - b) + p[3 * triangle + 2] * b) * a;
    };
    Vec3 from = random.in_box(bounds.lo, bounds.hi), to = on_triangle();
    if (i % 4 == 1) from = on_triangle();            // within the triangle's plane
    if (i % 4 == 2) from = to + (from - to) * 1e5f;  // from so far that coordinates are coarse
    if (i % 4 == 3) {                                // on a plane of the structure, along it or through it
      const Node& node = accel.nodes[random.below(static_cast<std::uint32_t>(accel.nodes.size()))];
      const int axis = static_cast<int>(random.below(3));
      const float at = node.plane[axis + 3 * static_cast<int>(random.below(2))][random.below(node.count)];
      to[axis] = at;
      if (random.below(2) != 0) from[axis] = at;
    }
    RayRequest& ray = out.emplace_back();
    ray.ray.origin = from;
    ray.ray.direction = to - from;
    if (ray.ray.direction == Vec3{0}) ray.ray.direction.x = 1;
    ray.tag.path = i;
    if (i % 16 == 0) ray.tag.kind = RayKind::kShadow;
  }
  return out;
}

TEST(ReferenceBuild, GivesTheAnswersOfEveryTriangle) {
  for (const bool grid : {false, true}) {
    const scene::Scene scene = long_and_small(120, run_seed() + grid, grid);
    for (const BvhConfig::Builder builder : kCutting) {
      for (const AccuracyConfig& accuracy : triangle_and_box_levels()) {
        const Accel accel = build_cut(scene, cutting(builder), accuracy);
        const BruteForceAnswers brute(scene, grazing_rays(scene, accel, 300, run_seed()), accuracy);
        EXPECT_EQ(brute.differences(accel), 0u) << enum_name(builder) << " " << text(accuracy) << " grid " << grid;
        EXPECT_GT(brute.hits(), 100u);
      }
    }
  }
}

// Many more rays than every triangle could be tested with.
TEST(ReferenceBuild, GivesTheAnswersOfTheStructureThatHoldsTrianglesOnce) {
  for (const bool grid : {false, true}) {
    const scene::Scene scene = long_and_small(2000, run_seed() + 7 + grid, grid);
    const Accel once = build_cut(scene, {});
    for (const BvhConfig::Builder builder : kCutting) {
      for (const double duplicates : {0.1, 4.0}) {
        for (const auto storage : {BvhConfig::Storage::kFull, BvhConfig::Storage::kQuantised}) {
          BvhConfig config = cutting(builder, duplicates);
          config.storage = storage;
          const Accel cut = build_cut(scene, config);
          const RayBatch rays = grazing_rays(scene, cut, 20000, run_seed());
          HitBatch expected, got;
          IntersectionCounts counts;
          trace_depth_first(once, rays, expected, counts);
          trace_depth_first(cut, rays, got, counts);
          std::size_t differences = 0, hits = 0;
          for (std::size_t i = 0; i < rays.size(); ++i) {
            differences += !same_result(expected[i], got[i]);
            hits += got[i].hit.valid();
          }
          EXPECT_EQ(differences, 0u) << enum_name(builder) << " " << duplicates << " " << enum_name(storage);
          EXPECT_GT(hits, rays.size() / 4);
        }
      }
    }
  }
}

// Spheres, instances with transforms, and triangles that let rays pass by chance.
TEST(ReferenceBuild, GivesOneAnswerInScenesOfAllKinds) {
  const HashedStop stop(0.4);
  for (const BuiltinScene builtin : {BuiltinScene::kInstances, BuiltinScene::kSpheres, BuiltinScene::kSliver}) {
    const scene::Scene scene = passing_scene(builtin, 12, run_seed());
    const BruteForceAnswers brute(scene, wishing_rays(scene, 300, run_seed() + 1), {}, &stop);
    for (const BvhConfig::Builder builder : kCutting) {
      for (const std::int64_t mixed : {0, 2}) {
        BvhConfig config = cutting(builder);
        config.mixed_triangles = mixed;
        config.leaf_triangles = mixed == 0 ? 4 : 1;
        Accel accel = build_cut(scene, config);
        accel.any_hit = &stop;
        EXPECT_EQ(brute.differences(accel), 0u) << enum_name(builtin) << " " << enum_name(builder);
      }
    }
  }
}

BuildPrimitives whole(const scene::Scene& scene) {
  BuildPrimitives out;
  const auto& p = scene.meshes[0].positions;
  for (std::uint32_t i = 0; i < p.size() / 3; ++i) {
    Aabb box;
    for (std::uint32_t k = 0; k < 3; ++k) box.extend(p[3 * i + k]);
    out.push_back({box.lo, i, box.hi});
  }
  return out;
}

double volume(const Aabb& box) {
  const DVec3 e = DVec3(box.hi) - DVec3(box.lo);
  return e.x * e.y * e.z;
}

// The pieces of a box make up the whole of it and overlap nowhere; no leaf holds two of them; no more are cut than may.
TEST(ReferenceBuild, CutsBoxesWithoutRemainder) {
  const scene::Scene scene = long_and_small(600, run_seed(), false);
  const BuildPrimitives primitives = whole(scene);
  for (const BvhConfig::Builder builder : kCutting) {
    for (const double duplicates : {0.0, 0.25, 3.0}) {
      BuildPrimitives references = primitives;
      const BinaryTree tree = build_references(references, {}, builder, duplicates);
      EXPECT_LE(references.size(), static_cast<std::size_t>((1 + duplicates) * 600));
      if (duplicates > 0) {
        EXPECT_GT(references.size(), 620u) << enum_name(builder);
      }
      std::vector<double> pieces(primitives.size());
      for (const BuildPrimitive& p : references) pieces[p.index] += volume({p.lo, p.hi});
      for (const BuildPrimitive& p : primitives)
        EXPECT_NEAR(pieces[p.index], volume({p.lo, p.hi}), 1e-9 * volume({p.lo, p.hi}));
      std::size_t held = 0;
      for (const BinaryNode& node : tree) {
        if (node.count == 0) continue;
        std::set<std::uint32_t> indices;
        for (std::uint32_t i = 0; i < node.count; ++i) indices.insert(references[node.first + i].index);
        EXPECT_EQ(indices.size(), node.count);
        EXPECT_LE(node.count, SahSettings{}.leaf_primitives);
        held += node.count;
      }
      EXPECT_EQ(held, references.size());
    }
  }
}

// The reference build is for long triangles, among which it spares a ray boxes and triangles.
TEST(ReferenceBuild, SparesTests) {
  const scene::Scene scene = long_and_small(3000, run_seed(), false);
  const RayBatch rays = mixed_rays(scene, 3000, run_seed());
  const auto tests = [&](const BvhConfig& config) {
    HitBatch hits;
    IntersectionCounts counts;
    trace_depth_first(build_cut(scene, config), rays, hits, counts);
    return counts.box + counts.triangle;
  };
  EXPECT_LT(tests(cutting(BvhConfig::Builder::kSpatial)), tests({}));
  BvhConfig moved;
  moved.quality = BvhConfig::Quality::kHigh;
  EXPECT_LT(tests(moved), tests({}));
}

}  // namespace
}  // namespace carousel::accel

// Structures of more than two levels against every triangle tested in scalar code, which knows nothing of groups: bits
// equal, whatever the levels, the level of accuracy and the distance of rays.
#include "accel/builders/group_levels.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "accel/traverse/exact_reference.h"
#include "scene/builtin/random_rotation.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/levels.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

constexpr std::int64_t kLevels[] = {2, 3, 4, 5, 8};

Accel with_levels(const scene::Scene& scene, std::int64_t levels, const AccuracyConfig& accuracy = {},
                  std::int64_t width = 4, BvhConfig::Storage storage = BvhConfig::Storage::kFull) {
  BvhConfig config;
  config.levels = levels;
  config.width = width;
  config.storage = storage;
  return build(scene, config, *make_sequential_executor(), accuracy);
}

scene::Scene nested(std::int64_t levels, std::int64_t instances = 40) {
  return small_builtin(BuiltinScene::kInstances, 0, instances, levels);
}

/// Rays of mixed_rays() that start `factor` times as far from where they go.
RayBatch far_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed, float factor) {
  RayBatch rays = whole_rays(scene, count, seed);
  for (RayRequest& r : rays) r.ray.origin -= (factor - 1) * r.ray.direction;
  return rays;
}

/// Rays that all triangles are tried with, one by one.
std::size_t few(int rays) {
  return static_cast<std::size_t>(scaled(rays, 100));
}

void expect_equal(const scene::Scene& scene, const RayBatch& rays, const AccuracyConfig& accuracy = {}) {
  const BruteForceAnswers brute(scene, rays, accuracy);
  EXPECT_GT(brute.hits(), rays.size() / 8);
  for (const std::int64_t levels : kLevels)
    EXPECT_EQ(brute.differences(with_levels(scene, levels, accuracy)), 0u) << levels << " levels " << text(accuracy);
}

/// Levels of structures on the way to the deepest mesh.
int deepest(const Accel& accel, std::uint32_t instance, int above = 1) {
  if (!accel.is_group(instance)) return above + 1;
  int most = 0;
  std::vector<NodeKey> open{{instance, accel.instances[instance].root}};
  while (!open.empty()) {
    const NodeKey key = open.back();
    open.pop_back();
    const Node& node = accel.nodes[key.ref.node()];
    for (int lane = 0; lane < node.count; ++lane) {
      const NodeKey child = accel.child_key(key, lane);
      if (node.child[lane].is_instance())
        most = std::max(most, deepest(accel, child.instance, above + 1));
      else
        open.push_back(child);
    }
  }
  return most;
}

int levels_of(const Accel& accel) {
  int most = 2;
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i)
    if (!accel.instances[i].member && accel.instances[i].triangles > 0) most = std::max(most, deepest(accel, i));
  return most;
}

TEST(GroupLevels, KeepAsManyLevelsAsTheSceneAndTheConfigurationHave) {
  for (const std::int64_t of_scene : {3, 5, 8})
    for (const std::int64_t levels : kLevels) {
      const scene::Scene scene = nested(of_scene, 300);
      const Accel accel = with_levels(scene, levels);
      EXPECT_EQ(levels_of(accel), std::min(of_scene, levels)) << of_scene << " levels, at most " << levels;
      EXPECT_EQ(accel.groups.empty(), levels == 2);
      // Every instance is reached once: from the top level or as a member.
      std::vector<int> reached(accel.instances.size());
      for (const std::uint32_t member : accel.members) ++reached[member];
      for (std::size_t i = 0; i < accel.instances.size(); ++i) EXPECT_EQ(reached[i], accel.instances[i].member);
    }
}

TEST(GroupLevels, ShareTheNodesOfAGroup) {
  const scene::Scene scene = nested(4, 1000);
  const Accel flat = with_levels(scene, 2), shared = with_levels(scene, 4);
  EXPECT_LT(2 * shared.nodes.size(), flat.nodes.size() + shared.groups.size());
  std::set<std::uint32_t> structures;
  for (std::size_t i = scene.instances.size(); i < shared.instances.size(); ++i)
    structures.insert(shared.instances[i].root.bits());
  EXPECT_LE(structures.size(), scene.groups.size());
  EXPECT_GT(shared.groups.size(), 5 * structures.size());
}

TEST(GroupLevels, ChangeNoHitAtAnyLevelOfAccuracy) {
  const scene::Scene scene = nested(5);
  const RayBatch rays = mixed_rays(scene, few(600), 31);
  for (const auto& transform : kEnumNames<TransformLevel>) {
    AccuracyConfig accuracy;
    accuracy.transform = transform.value;
    expect_equal(scene, rays, accuracy);
  }
  for (const AccuracyConfig& accuracy : triangle_and_box_levels()) expect_equal(scene, rays, accuracy);
}

TEST(GroupLevels, ChangeNoHitInScenesOfAnyDepth) {
  for (const std::int64_t levels : {3, 4, 8})
    expect_equal(nested(levels, 150), mixed_rays(nested(levels, 150), few(500), 32));
}

TEST(GroupLevels, ChangeNoHitOfRaysFromFarAway) {
  const scene::Scene scene = nested(5);
  for (const float factor : some(std::vector{30.0f, 1e3f, 1e5f}, 2))
    for (const auto& transform : kEnumNames<TransformLevel>) {
      AccuracyConfig accuracy;
      accuracy.transform = transform.value;
      expect_equal(scene, far_rays(scene, few(400), 33, factor), accuracy);
    }
}

TEST(GroupLevels, ChangeNoHitForAnyTreeAndTarget) {
  const scene::Scene scene = nested(6, 60);
  const BruteForceAnswers brute(scene, mixed_rays(scene, 500, 34));
  for (const SimdTarget target : usable_simd_targets()) {
    const SimdGuard guard;
    select_simd_target(target);
    for (const std::int64_t width : {2, 3, 8})
      for (const auto& storage : kEnumNames<BvhConfig::Storage>)
        EXPECT_EQ(brute.differences(with_levels(scene, 8, {}, width, storage.value)), 0u) << width;
  }
}

TEST(GroupLevels, ChangeNoHitOfRaysOfAnyBits) {
  const scene::Scene scene = nested(5, 60);
  Random random(35);
  RayBatch rays;
  for (int i = 0; i < 1500; ++i) {
    RayRequest r = ray_to(random.in_box(Vec3{-9}, Vec3{9}), random.in_box(Vec3{-1}, Vec3{1}));
    if (i % 2) r.ray.origin[static_cast<int>(random.below(3))] = random.any_bits();
    if (i % 3) r.ray.direction[static_cast<int>(random.below(3))] = random.any_bits();
    if (i % 5 == 0) r.ray.tmin = random.any_bits();
    if (i % 7 == 0) r.ray.tmax = random.any_bits();
    rays.push_back(r);
  }
  expect_equal(scene, rays);
}

TEST(GroupLevels, ChangeNoAnswerOfAnyHit) {
  const scene::Scene scene = passing_scene(BuiltinScene::kInstances, 12, 36, 5);
  const HashedStop stop(0.4);
  const BruteForceAnswers brute(scene, wishing_rays(scene, 800, 37), {}, &stop);
  EXPECT_GT(brute.hits(), 100u);
  for (const std::int64_t levels : kLevels) {
    Accel accel = with_levels(scene, levels);
    accel.any_hit = &stop;
    EXPECT_EQ(brute.differences(accel), 0u) << levels;
  }
}

/// Balls in groups in groups, `places` of each, that are turned, stretched by 10^`stretch` at most either way, and
/// stand up to `away` from the world's origin.
enum class Flat { kNothing, kBall, kGroup };
scene::Scene hard_groups(std::uint64_t seed, double stretch, double away, Flat flat = Flat::kNothing) {
  scene::Scene scene = empty_scene();
  for (int i = 0; i < 2; ++i) {
    scene::Mesh ball;
    scene::add_icosphere(ball, Vec3{0.3f * static_cast<float>(i)}, 0.5f, 1, MaterialId(0));
    (void)add_mesh(scene, ball);
  }
  (void)add_mesh(scene, {});  // shows nothing
  scene.groups = {
      {{{false, 0}, {false, 1}, {false, 2}}}, {{{true, 0}, {false, 1}, {true, 0}}}, {{{true, 1}, {true, 0}}}};
  scene::HashRandom random(seed, 0);
  const auto map = [&](double size) {
    const auto scale = [&] { return std::pow(10.0, stretch * double(random.uniform(-1, 1))); };
    const double x = scale(), y = scale(), z = scale();
    DMat4 m(DMat3(scene::random_rotation(random)) * DMat3(x, 0, 0, 0, y, 0, 0, 0, random.below(3) == 0 ? -z : z));
    for (int axis = 0; axis < 3; ++axis) m[3][axis] = size * double(random.uniform(-1, 1));
    return m;
  };
  std::vector<std::vector<DMat4>> members;
  for (const scene::Group& group : scene.groups) {
    members.emplace_back();
    for (std::size_t m = 0; m < group.members.size(); ++m) members.back().push_back(map(3));
  }
  if (flat == Flat::kBall) members[0][1][2] = {};
  if (flat == Flat::kGroup) members[1][2][2] = {};
  const auto rounded = [](const DMat4& m) { return scene::Affine{Mat3(DMat3(m)), Vec3(m[3])}; };
  struct Open {
    DMat4 world;
    scene::Group::Member what;
    std::uint32_t parent, member;
  };
  for (int k = 0; k < 5; ++k) {
    std::vector<Open> stack{{k == 0 ? DMat4(1) : map(away), {true, 2}, scene::kNoPlacement, 0}};
    while (!stack.empty()) {
      const Open at = stack.back();
      stack.pop_back();
      if (!at.what.is_group) {
        scene.instances.push_back({MeshId(at.what.index), rounded(at.world), at.parent, at.member});
        continue;
      }
      const auto placement = static_cast<std::uint32_t>(scene.placements.size());
      scene.placements.push_back({at.what.index, rounded(at.world), at.parent, at.member});
      const scene::Group& group = scene.groups[at.what.index];
      for (std::uint32_t m = 0; m < group.members.size(); ++m)
        stack.push_back({at.world * members[at.what.index][m], group.members[m], placement, m});
    }
  }
  add_instance(scene, 0);
  return scene;
}

/// Rays at corners and edges of triangles, from as near as they are long to outside the scene.
RayBatch aimed_rays(const scene::Scene& scene, std::size_t count, std::uint64_t seed) {
  scene::Scene shown = scene;
  for (scene::Instance& instance : shown.instances) instance.mesh = MeshId(instance.mesh.value % 2);
  Random random(seed);
  const float size = glm::length(scene.bounds().extent());
  RayBatch rays;
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Vec3, 3> p = random_triangle(shown, random);
    const Vec3 at = i % 3 == 0 ? p[0] : p[0] + random.uniform() * (p[1] - p[0]);
    const float least = glm::length(p[1] - p[0]) + glm::length(p[2] - p[0]);
    const float away = least * std::pow(3 * size / least, i % 4 == 0 ? 0.0f : random.uniform());
    const Vec3 from = at + away * glm::normalize(random.in_box(Vec3{-1}, Vec3{1}) + Vec3{1e-3f});
    rays.push_back(ray_to(from, i % 2 == 0 ? at - from : (at - from) * (1 / away)));
  }
  return rays;
}

TEST(GroupLevels, ChangeNoHitInHardGroups) {
  for (const double stretch : some(std::vector{0.2, 0.6, 1.5}))
    for (const double away : {3.0, 1e3, 1e5}) {
      const scene::Scene scene = hard_groups(38, stretch, away);
      for (const auto& transform : kEnumNames<TransformLevel>) {
        AccuracyConfig accuracy;
        accuracy.transform = transform.value;
        const BruteForceAnswers brute(scene, aimed_rays(scene, 400, 39), accuracy);
        EXPECT_GT(brute.hits(), 40u);
        for (const std::int64_t levels : kLevels) {
          const Accel accel = with_levels(scene, levels, accuracy);
          EXPECT_EQ(accel.groups.size(), levels == 2 ? 0u : levels == 3 ? 5u : levels == 4 ? 15u : 25u);
          EXPECT_EQ(brute.differences(accel), 0u) << stretch << ' ' << away << ' ' << enum_name(transform.value);
        }
      }
    }
}

// Squares that fill their boxes: composed translations are rounded, so that each stands elsewhere in each placement.
TEST(GroupLevels, ChangeNoHitOfSquaresFarFromTheOrigin) {
  scene::Scene scene = empty_scene();
  (void)add_mesh(scene, soup({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  scene.groups = {{{{false, 0}, {false, 0}, {false, 0}}}};
  Random random(43);
  const Vec3 members[] = {{0.1f, 0.7f, 0.3f}, {1.3f, -0.6f, 2.9f}, {-1.7f, 0.2f, 1.1f}};
  for (std::uint32_t k = 0; k < 12; ++k) {
    const Vec3 at = k == 0 ? Vec3{0} : random.in_box(Vec3{-2e4f}, Vec3{2e4f});
    scene.placements.push_back({0, {Mat3(1.0f), at}});
    for (std::uint32_t m = 0; m < 3; ++m)
      scene.instances.push_back({MeshId(0), {Mat3(1.0f), Vec3(DVec3(at) + DVec3(members[m]))}, k, m});
  }
  expect_equal(scene, aimed_rays(scene, 1500, 44));
}

// A member that has no inverse is baked; a group that has none gives its members to the group around it.
TEST(GroupLevels, HoldInstancesThatAreBaked) {
  const scene::Scene scene = hard_groups(40, 0.3, 3, Flat::kBall);
  expect_equal(scene, aimed_rays(scene, 600, 41));
  const Accel accel = with_levels(scene, 8);
  EXPECT_EQ(accel.baked_instances, 15u);
  EXPECT_EQ(accel.groups.size(), 25u);
}

TEST(GroupLevels, LeaveOutGroupsThatAreFlat) {
  const scene::Scene scene = hard_groups(40, 0.3, 3, Flat::kGroup);
  expect_equal(scene, aimed_rays(scene, 600, 41));
  EXPECT_EQ(with_levels(scene, 8).groups.size(), 10u);
}

TEST(GroupLevels, AgreeWithTheExactReference) {
  const scene::Scene scene = nested(5, 60);
  AccuracyConfig accuracy;
  accuracy.triangle = TriangleLevel::kExact;
  const Accel levels = with_levels(scene, 8, accuracy);
  const ExactReference reference(scene);
  const RayBatch rays = whole_rays(scene, 1800, 42);
  int hits = 0;
  for (std::size_t i = 0; i < rays.size(); i += 6) {  // every sixth ray is aimed at no edge
    const ExactHit exact = reference.closest(rays[i].ray);
    const Hit hit = trace_one(levels, rays[i]);
    hits += exact.hit.valid();
    EXPECT_EQ(hit.instance, exact.hit.instance);
    EXPECT_EQ(hit.primitive, exact.hit.primitive);
  }
  EXPECT_GT(hits, 30);
}

}  // namespace
}  // namespace carousel::accel

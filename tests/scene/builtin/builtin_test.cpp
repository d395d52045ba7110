#include "scene/builtin/builtin.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "core/system/error.h"

namespace carousel::scene {
namespace {

const BuiltinScene kAll[] = {BuiltinScene::kCornell,   BuiltinScene::kSpheres, BuiltinScene::kTerrain,
                             BuiltinScene::kInstances, BuiltinScene::kSliver,  BuiltinScene::kFoliage};

SceneConfig config_of(BuiltinScene kind) {
  SceneConfig config;
  config.builtin = kind;
  config.triangles = 5000;
  config.instances = 300;
  return config;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_geometry(const Scene& a, const Scene& b) {
  if (a.meshes.size() != b.meshes.size() || a.instances.size() != b.instances.size()) return false;
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    if (!same_bits(a.meshes[m].positions, b.meshes[m].positions)) return false;
    if (!same_bits(a.meshes[m].indices, b.meshes[m].indices)) return false;
    if (!same_bits(a.meshes[m].normals, b.meshes[m].normals)) return false;
  }
  return same_bits(a.instances, b.instances);
}

TEST(Builtin, IsDeterministic) {
  for (const BuiltinScene kind : kAll) {
    EXPECT_TRUE(same_geometry(make_builtin(config_of(kind)), make_builtin(config_of(kind))));
  }
}

TEST(Builtin, NestsInstancesInGroupsThatArePlacedManyTimes) {
  for (const std::int64_t levels : {3, 4, 5, 6, 7, 8})
    for (const std::int64_t instances : {1, 7, 300, 2000}) {
      SceneConfig config = config_of(BuiltinScene::kInstances);
      config.levels = levels;
      config.instances = instances;
      const Scene scene = make_builtin(config);
      EXPECT_TRUE(same_geometry(scene, make_builtin(config)));
      ASSERT_EQ(scene.instances.size(), static_cast<std::size_t>(instances) + 1);  // and the ground
      std::vector<int> depth;
      int deepest = 0;
      for (const GroupPlacement& p : scene.placements) {
        depth.push_back(p.parent == kNoPlacement ? 1 : 1 + depth.at(p.parent));
        deepest = std::max(deepest, depth.back());
        if (p.parent == kNoPlacement) continue;
        const Group::Member& member = scene.groups[scene.placements[p.parent].group].members.at(p.member);
        EXPECT_TRUE(member.is_group && member.index == p.group);
      }
      for (const Instance& i : scene.instances) {
        if (i.placement == kNoPlacement) continue;
        const Group::Member& member = scene.groups[scene.placements[i.placement].group].members.at(i.member);
        EXPECT_TRUE(!member.is_group && member.index == i.mesh.value);
      }
      if (instances >= 300) {
        EXPECT_EQ(deepest, levels - 2);
        EXPECT_GT(scene.placements.size(), scene.groups.size());
      }
    }
}

TEST(Builtin, SeedChangesTheSeededOnes) {
  for (const BuiltinScene kind : kAll) {
    if (kind == BuiltinScene::kCornell) continue;
    SceneConfig other = config_of(kind);
    other.seed = 2;
    EXPECT_FALSE(same_geometry(make_builtin(config_of(kind)), make_builtin(other)));
  }
}

TEST(Builtin, EveryIndexIsInRangeAndEveryArrayFits) {
  for (const BuiltinScene kind : kAll) {
    const Scene scene = make_builtin(config_of(kind));
    SCOPED_TRACE(scene.name);
    EXPECT_FALSE(scene.cameras.empty());
    EXPECT_FALSE(scene.materials.empty());
    for (const Mesh& mesh : scene.meshes) {
      EXPECT_EQ(mesh.indices.size() % 3, 0u);
      EXPECT_EQ(mesh.triangle_materials.size(), mesh.triangle_count());
      EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
      EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == mesh.positions.size());
      for (const std::uint32_t i : mesh.indices) ASSERT_LT(i, mesh.positions.size());
      for (const MaterialId m : mesh.triangle_materials) ASSERT_LT(m.value, scene.materials.size());
      for (const Vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
      for (const Vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    }
    for (const Instance& i : scene.instances) ASSERT_LT(i.mesh.value, scene.meshes.size());
    for (const Camera& c : scene.cameras) {
      EXPECT_NEAR(glm::dot(glm::cross(c.right, c.up), c.back), 1.0f, 1e-5f);
    }
  }
}

TEST(Builtin, SmoothNormalsAgreeWithTheWinding) {
  for (const BuiltinScene kind : kAll) {
    const Scene scene = make_builtin(config_of(kind));
    for (const Mesh& mesh : scene.meshes) {
      SCOPED_TRACE(scene.name + " " + mesh.name);
      if (mesh.normals.empty()) continue;
      for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
        const Vec3 face = glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        ASSERT_GT(glm::dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]), 0.0f) << t / 3;
      }
    }
  }
}

TEST(Builtin, TriangleCountIsAboutWhatWasAskedFor) {
  for (const std::int64_t wanted : {1, 30, 1000, 20000, 300000}) {
    for (const BuiltinScene kind : {BuiltinScene::kSpheres, BuiltinScene::kTerrain, BuiltinScene::kSliver}) {
      SceneConfig config = config_of(kind);
      config.triangles = wanted;
      const Scene scene = make_builtin(config);
      const double got = static_cast<double>(scene.instanced_triangle_count());
      EXPECT_NEAR(got, static_cast<double>(wanted), 0.02 * static_cast<double>(wanted) + 22) << scene.name;
    }
  }
}

TEST(Builtin, InstancesAreAsManyAsAskedForAndSomeMirrored) {
  const Scene scene = make_instances(1000, 1);
  EXPECT_EQ(scene.instances.size(), 1001u);  // and the ground
  const auto mirrored = std::ranges::count_if(
      scene.instances, [](const Instance& i) { return glm::determinant(i.world_from_model.linear) < 0; });
  EXPECT_EQ(mirrored, 250);
}

TEST(Builtin, SliversReachAnAspectOfNearlyOneToAHundredThousand) {
  const Scene scene = make_sliver(20000, 1);
  const Mesh& mesh = scene.meshes[0];
  float most = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const Vec3 a = mesh.positions[t], b = mesh.positions[t + 1], c = mesh.positions[t + 2];
    if (const float width = glm::length(b - a); width > 0) most = std::max(most, glm::length(c - a) / width);
  }
  EXPECT_GT(most, 5e4f);
}

TEST(Builtin, CountsOutOfRangeAreRefused) {
  SceneConfig config = config_of(BuiltinScene::kTerrain);
  config.triangles = 0;
  EXPECT_THROW(make_builtin(config), ConfigError);
  config = config_of(BuiltinScene::kInstances);
  config.instances = std::int64_t{1} << 40;
  EXPECT_THROW(make_builtin(config), ConfigError);
}

}  // namespace
}  // namespace carousel::scene

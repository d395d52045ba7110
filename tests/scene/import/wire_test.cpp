// What a module hands over is checked: bytes that are cut off or changed lead to errors.
#include "scene/import/wire.h"

#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/system/error.h"
#include "scene/builtin/hash_random.h"
#include "scene/import/import_file.h"
#include "tests/support/random_runs.h"

namespace carousel::scene::wire_test {
namespace {

const std::function<void(std::uint64_t)> kAny = [](std::uint64_t) {};

/// One triangle, shown by the second of two nodes.
Imported triangle() {
  Imported out;
  out.warnings = {"one"};
  out.images.push_back({"wood", "a.mtl:3", "", {1, 2, 3, 4}, 1, 1});
  out.textures.emplace_back();
  Material& material = out.materials.emplace_back();
  material.name = "red";
  material.base_color = {1, 0, 0, 1};
  material.base_color_texture = TextureUse{};
  material.alpha_mode = AlphaMode::kBlend;
  Mesh& mesh = out.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2};
  mesh.triangle_materials = {MaterialId(0)};
  const std::array<double, 16> moved{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1};
  out.nodes.push_back({"root", -1, moved, -1});
  out.nodes.push_back({"leaf", 0, moved, 0});
  out.cameras.push_back({1, "eye", {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 0.5f, 0, 0, 0});
  out.lights.push_back({0, PunctualLight::Kind::kSpot, {1, 2, 3}, {}, {0, -1, 0}, 0.1f, 0.2f});
  out.motion.clips.push_back({"walk", 2, 3});
  out.animations.push_back({{0, {0, 1}, {0, 1}, {0}, {5, 0, 0, 5, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 1}, {1, 1, 1}}});
  out.skins.push_back({0, {{0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}, {0, 1}, {1, 0.5f}}}});
  out.files = {"a.obj"};
  return out;
}

std::string bytes_of(Imported imported) {
  std::string out;
  WireWriter{out}(imported);
  return out;
}

Imported read(std::string_view bytes) {
  Imported out;
  WireReader reader(std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()), kAny);
  reader(out);
  if (!reader.at_end()) throw std::runtime_error("bytes are left over");
  return out;
}

Scene scene_of(Imported imported) {
  MemoryBudget memory(1 << 20);
  return scene::scene_of(std::move(imported), "a.obj", {}, memory, PoseChoice{0.5f, std::nullopt});
}

TEST(ImportWire, AllValuesComeBack) {
  const Imported back = read(bytes_of(triangle()));
  EXPECT_EQ(bytes_of(back), bytes_of(triangle()));
  const Scene scene = scene_of(back);
  EXPECT_EQ(scene.name, "a");
  EXPECT_EQ(scene.instances.at(0).world_from_model.translation, Vec3(0)) << "a mesh with bones stands in the world";
  EXPECT_EQ(scene.meshes.at(0).positions, (std::vector<Vec3>{{10, 0, 0}, {11, 0, 0}, {10, 1, 0}}));
  EXPECT_EQ(scene.materials.at(0).base_color, Vec4(1, 0, 0, 1));
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::kBlend);
  EXPECT_EQ(scene.cameras.at(0).position, Vec3(10, 0, 3));
  EXPECT_EQ(scene.lights.at(0).direction, Vec3(0, -1, 0));
  EXPECT_EQ(scene.nodes.at(1).name, "leaf");
  EXPECT_EQ(scene.motion.clips.at(0).seconds, 2);
}

TEST(ImportWire, EveryTruncationIsRefused) {
  const std::string whole = bytes_of(triangle());
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(read(std::string_view(whole).substr(0, size)), std::runtime_error) << size;
  EXPECT_THROW(read(whole + "x"), std::runtime_error);
}

TEST(ImportWire, ChangedBytesLoadOrAreRefused) {
  const std::string whole = bytes_of(triangle());
  std::size_t loaded = 0;
  const int mutants = scaled(20000);
  for (int i = 0; i < mutants; ++i) {
    HashRandom random(run_seed() + static_cast<std::uint64_t>(i), 11);
    std::string bytes = whole;
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n)
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(random.below(256));
    try {
      const Scene scene = scene_of(read(bytes));
      ++loaded;
      for (const Mesh& mesh : scene.meshes)
        for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, mesh.positions.size());
      for (const Instance& instance : scene.instances) ASSERT_LT(instance.mesh.value, scene.meshes.size());
    } catch (const std::runtime_error&) {
    }
  }
  EXPECT_GT(loaded, static_cast<std::size_t>(mutants) / 20);
}

TEST(ImportWire, MemoryIsAskedForBeforeItIsTaken) {
  std::string bytes = bytes_of(triangle());
  std::uint64_t taken = 0;
  const std::function<void(std::uint64_t)> count = [&](std::uint64_t more) { taken += more; };
  Imported out;
  WireReader(std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()), count)(out);
  EXPECT_GE(taken, 3 * sizeof(Vec3) + 3 * sizeof(std::uint32_t) + 2 * sizeof(Imported::Node));
}

TEST(ImportWire, WhatDoesNotFitTogetherIsRefused) {
  const auto refused = [](const std::function<void(Imported&)>& damage, const std::string& message) {
    Imported bad = triangle();
    damage(bad);
    try {
      scene_of(bad);
      ADD_FAILURE() << message;
    } catch (const std::runtime_error& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
  };
  refused([](Imported& i) { i.meshes[0].indices[1] = 3; }, "an index is beyond its vertices");
  refused([](Imported& i) { i.meshes[0].normals.resize(2); }, "not one value a vertex");
  refused([](Imported& i) { i.meshes[0].positions[1].y = INFINITY; }, "vertex 1: the position is not finite");
  refused([](Imported& i) { i.nodes[1].parent = 1; }, "the nodes form no tree");
  refused([](Imported& i) { i.nodes[1].mesh = 1; }, "the nodes form no tree");
  refused([](Imported& i) { i.skins.clear(), i.nodes[1].local[12] = 1e300; },
          "node 1 \"leaf\": the transform to world space is too large");
  refused([](Imported& i) { i.materials[0].base_color_texture->texture = TextureId(1); }, "names no texture");
  refused([](Imported& i) { i.textures[0].image = ImageId(7); }, "a texture names no image");
  refused([](Imported& i) { i.cameras[0].node = 2; }, "a camera or a light has no node");
  refused([](Imported& i) { i.nodes[1].mesh = -1; }, "the scene shows no triangles");
  refused([](Imported& i) { i.nodes[1].local[12] = 1e300; }, "the pose moves vertex 2 of mesh");
  refused([](Imported& i) { i.skins[0].mesh = 1; }, "a skin has no mesh");
  refused([](Imported& i) { i.skins.push_back(i.skins[0]); }, "a mesh has two skins");
  refused([](Imported& i) { i.skins[0].bones[0].node = 2; }, "a bone has no node");
  refused([](Imported& i) { i.skins[0].bones[0].vertices[0] = 3; }, "a bone moves no vertex");
  refused([](Imported& i) { i.skins[0].bones[0].weights.clear(); }, "a bone has not one weight a vertex");
  refused([](Imported& i) { i.animations[0][0].node = 2; }, "an animation moves no node");
  refused([](Imported& i) { i.animations.clear(); }, "an animation has no name");
  refused([](Imported& i) { i.animations[0][0].translations.pop_back(); }, "not one value a time");
  refused([](Imported& i) { i.animations[0][0].rotation_times = {1, 0}; }, "keys of an animation are not in order");
  refused([](Imported& i) { i.animations[0][0].rotations = {0, 0, 0, 0, 0, 0, 0, 1}; }, "a rotation is zero");
}

}  // namespace
}  // namespace carousel::scene::wire_test

#include <glm/geometric.hpp>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

TEST(GltfMesh, PrimitivesAreConcatenatedInOrderWithTheirMaterials) {
  GltfBuilder b = GltfBuilder::square();
  b.push("materials", {{"name", "first"}});
  b.push("materials", {{"name", "second"}});
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[0]["material"] = 1;
  const Scene scene = b.load();
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangle_count(), 4u);
  EXPECT_EQ(mesh.positions.size(), 4u);  // equal attributes are shared
  EXPECT_EQ(mesh.triangle_materials,
            (std::vector<MaterialId>{MaterialId(1), MaterialId(1), MaterialId(2), MaterialId(2)}));
  EXPECT_EQ(scene.materials[2].name, "default");
}

TEST(GltfMesh, FewTrianglesOfManyVerticesKeepOnlyTheirOwn) {
  GltfBuilder b;
  std::vector<float> line;
  for (int i = 0; i < 100; ++i) line.insert(line.end(), {static_cast<float>(i), static_cast<float>(i * i), 0});
  const int positions = b.floats(line, "VEC3", 3);
  b.mesh({{"POSITION", positions}}, b.accessor(b.view(std::vector<std::uint8_t>{90, 10, 50}), 5121, 3, "SCALAR"));
  const Mesh mesh = b.load().meshes[0];
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{10, 100, 0}, {50, 2500, 0}, {90, 8100, 0}}));
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 0, 1}));
}

TEST(GltfMesh, PrimitiveWithoutNormalsBesideOneWithThemGetsFlatOnes) {
  GltfBuilder b = GltfBuilder::square();
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["attributes"]["NORMAL"] = b.floats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3", 3);
  const Mesh mesh = b.load().meshes[0];
  ASSERT_EQ(mesh.positions.size(), 6u + 4u);
  ASSERT_EQ(mesh.normals.size(), 10u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(mesh.normals[i], Vec3(0, 0, 1));
  for (std::size_t i = 6; i < 10; ++i) EXPECT_EQ(mesh.normals[i], Vec3(0, 1, 0));
}

TEST(GltfMesh, ZeroNormalBecomesTheMeanOfItsFaces) {
  GltfBuilder b = GltfBuilder::square();
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      b.floats({0, 0, 0, 0, 2, 0, 0, 2, 0, 0, 2, 0}, "VEC3", 3);
  const Mesh mesh = b.load().meshes[0];
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[1], Vec3(0, 1, 0));
}

TEST(GltfMesh, MissingUvOfOnePrimitiveIsPadded) {
  GltfBuilder b = GltfBuilder::square();
  Json& primitives = b.json["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["attributes"]["TEXCOORD_0"] = b.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const Mesh mesh = b.load().meshes[0];
  ASSERT_EQ(mesh.uv0.size(), mesh.positions.size());
  EXPECT_EQ(mesh.uv0[2], Vec2(0, 0));
  EXPECT_EQ(mesh.uv0[6], Vec2(1, 1));
}

TEST(GltfMesh, PointsAndLinesAreSkippedWithOneWarning) {
  GltfBuilder b = GltfBuilder::square();
  Json& primitives = b.json["meshes"][0]["primitives"];
  for (int mode = 0; mode < 4; ++mode) {
    primitives.push_back(primitives[0]);
    primitives.back()["mode"] = mode;
  }
  std::vector<std::string> warnings;
  const Scene scene = b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(scene.meshes[0].triangle_count(), 2u);
  EXPECT_EQ(warnings, std::vector<std::string>{"test.gltf: 4 primitives skipped: points, lines or without positions"});
}

TEST(GltfMesh, SceneWithoutTrianglesIsRefused) {
  GltfBuilder b = GltfBuilder::square();
  b.json["meshes"][0]["primitives"][0]["mode"] = 0;
  expect_refused(b, "", "shows no triangles");
}

TEST(GltfMesh, MeshesNobodyShowsAreLeftOut) {
  GltfBuilder b = GltfBuilder::square();
  b.push("meshes", {{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}}}})}});
  EXPECT_EQ(b.load().meshes.size(), 1u);
}

}  // namespace
}  // namespace carousel::scene

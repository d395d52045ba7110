// Faults of a file that change nothing that is shown are warnings: the scene is the one without the fault.
#include <algorithm>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = GltfBuilder::Json;

/// The warnings of a file that has to load with as many instances and triangles as are given.
std::vector<std::string> warnings_of(const GltfBuilder& b, std::size_t instances = 1, std::size_t triangles = 2) {
  std::vector<std::string> out;
  const Scene scene = b.load([&](const std::string& text) { out.push_back(text); });
  EXPECT_EQ(scene.instances.size(), instances);
  EXPECT_EQ(scene.instanced_triangle_count(), triangles);
  return out;
}

void expect_warning(const GltfBuilder& b, const std::string& path, const std::string& message) {
  const std::vector<std::string> found = warnings_of(b);
  ASSERT_EQ(found.size(), 1u) << testing::PrintToString(found);
  EXPECT_NE(found[0].find("test.gltf: " + path + ": "), std::string::npos) << found[0];
  EXPECT_NE(found[0].find(message), std::string::npos) << found[0];
}

TEST(GltfFormalFaults, TexturesThatNoMaterialUses) {
  GltfBuilder b = GltfBuilder::square();
  b.push("textures", {{"source", 7}});
  expect_warning(b, "/textures/0/source", "nothing that is shown uses it");
  b.push("materials", {{"normalTexture", {{"index", 0}}}});
  EXPECT_THROW(b.load(), SceneError) << "a material uses it";
}

TEST(GltfFormalFaults, ImagesAndSamplersThatNoMaterialUses) {
  GltfBuilder b = GltfBuilder::square();
  b.push("images", Json::object());
  expect_warning(b, "/images/0", "exactly one of uri and bufferView");
  b = GltfBuilder::square();
  b.push("samplers", {{"wrapS", 1}});
  expect_warning(b, "/samplers/0/wrapS", "expected one of");
  b.push("images", {{"uri", "data:,"}});
  b.push("textures", {{"source", 0}, {"sampler", 0}});
  EXPECT_EQ(warnings_of(b).size(), 1u);
  b.push("materials", {{"occlusionTexture", {{"index", 0}}}});
  EXPECT_EQ(warnings_of(b).size(), 1u) << "occlusion is not shown";
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  EXPECT_THROW(b.load(), SceneError);
}

TEST(GltfFormalFaults, AnimationsAndSkins) {
  const Json target = {{"node", 0}, {"path", "scale"}};
  GltfBuilder b = GltfBuilder::square();
  b.push("animations", {{"channels", Json::array({{{"sampler", 3}, {"target", target}}})},
                        {"samplers", Json::array({{{"input", 0}, {"output", 0}}})}});
  const std::vector<std::string> found = warnings_of(b);
  EXPECT_TRUE(std::ranges::any_of(found, [](const std::string& text) {
    return text.find("/animations/0/channels/0/sampler: expected an index") != text.npos;
  })) << testing::PrintToString(found);
  b.json["animations"][0]["samplers"][0]["input"] = 99;
  EXPECT_EQ(warnings_of(b).size(), 2u);
  b.push("skins", {{"joints", {99}}});
  EXPECT_EQ(warnings_of(b).size(), 3u);
}

TEST(GltfFormalFaults, AccessorsThatNoMeshUses) {
  GltfBuilder b = GltfBuilder::square();
  const int cut_off = b.accessor(0, 5126, 1000, "VEC3");
  expect_warning(b, "/accessors/" + std::to_string(cut_off), "reach outside buffer view 0");
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = cut_off;
  EXPECT_THROW(b.load(), SceneError);
}

TEST(GltfFormalFaults, CamerasWithoutANode) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras", {{"type", "perspective"}});
  expect_warning(b, "/cameras/0/perspective", "missing");
  b.node({{"camera", 0}});
  EXPECT_THROW(b.load(), SceneError);
}

TEST(GltfFormalFaults, RootThatHasAParent) {
  GltfBuilder b = GltfBuilder::square();
  b.node({{"children", {0}}, {"translation", {5, 0, 0}}});
  expect_warning(b, "/scenes/0/nodes/0", "node 0 is not a root: it is a child of node 1, and is shown there once");
  EXPECT_EQ(b.load().bounds().lo, Vec3(5, 0, 0)) << "it is moved by its parent";
  b.json["scenes"][0]["nodes"] = {0};
  expect_warning(b, "/scenes/0/nodes/0", "which the scene does not show");
}

TEST(GltfFormalFaults, RootNamedTwice) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = {0, 0};
  expect_warning(b, "/scenes/0/nodes/1", "node 0 is named twice; it is shown once");
}

TEST(GltfFormalFaults, TextureCoordinatesThatNoTextureReads) {
  GltfBuilder b = GltfBuilder::square();
  b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = b.floats({0, 0, 1, 1}, "VEC2", 2);
  expect_warning(b, "/meshes/0/primitives/0/attributes/TEXCOORD_1", "no texture of the material reads it");
  b.push("images", {{"uri", "data:,"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"normalTexture", {{"index", 0}, {"texCoord", 1}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  try {
    b.load();
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.json_path(), "/meshes/0/primitives/0/attributes/TEXCOORD_1");
  }
}

TEST(GltfFormalFaults, OtherFaultsOfAnEmptySceneComeFirst) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0].erase("mesh");
  EXPECT_THROW(b.load(), SceneError);
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.floats({0, 0, 1}, "VEC3", 3);
  try {
    b.load();
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.json_path(), "/meshes/0/primitives/0/attributes/NORMAL") << error.what();
  }
}

TEST(GltfFormalFaults, TextOfAFileHasNoControlCharacters) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["name"] = "red\x1b[31m\nand\xc2\x9b";
  EXPECT_EQ(b.load().name, "red?[31m?and?");
  b.json["nodes"][0]["mesh"] = "\x1b]0;title\x07";
  try {
    b.load();
    FAIL();
  } catch (const SceneError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("?]0;title?"), text.npos) << text;
    EXPECT_EQ(text.find('\x1b'), text.npos);
  }
}

// Two sets of texture coordinates that name one accessor, though the stream holds both: each gets its own data, and
// another mesh may use the stream.
TEST(GltfFormalFaults, TwoSetsOfTextureCoordinatesInOneAccessorOfADracoStream) {
  const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Vec2 first[] = {{0, 0}, {1, 0}, {0, 1}}, second[] = {{0.5f, 0.25f}, {0.75f, 0.25f}, {0.5f, 0.125f}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const auto add = [&](draco::GeometryAttribute::Type type, std::int8_t width, const auto* values) {
    const int attribute = builder.AddAttribute(type, width, draco::DT_FLOAT32);
    builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(0), &values[0], &values[1], &values[2]);
    return attribute;
  };
  const int positions = add(draco::GeometryAttribute::POSITION, 3, corners);
  const int uv0 = add(draco::GeometryAttribute::TEX_COORD, 2, first);
  const int uv1 = add(draco::GeometryAttribute::TEX_COORD, 2, second);
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());

  GltfBuilder b;
  const int view = b.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
  const int points = b.accessor(-1, 5126, 3, "VEC3"), shared = b.accessor(-1, 5126, 3, "VEC2");
  const int indices = b.accessor(-1, 5123, 3, "SCALAR");
  const Json extension = {
      {"KHR_draco_mesh_compression",
       {{"bufferView", view}, {"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv0}, {"TEXCOORD_1", uv1}}}}}};
  const Json attributes = {{"POSITION", points}, {"TEXCOORD_0", shared}, {"TEXCOORD_1", shared}};
  b.mesh(attributes, indices, {{"extensions", extension}});
  b.mesh(attributes, indices, {{"extensions", extension}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.meshes.size(), 2u);
  for (const Mesh& m : scene.meshes) {
    ASSERT_EQ(m.positions.size(), 3u);
    for (std::size_t v = 0; v < 3; ++v) {
      const auto corner = std::find(std::begin(corners), std::end(corners), m.positions[v]) - std::begin(corners);
      ASSERT_LT(corner, 3);
      EXPECT_EQ(m.uv0.at(v), first[corner]);
      EXPECT_EQ(m.uv1.at(v), second[corner]);
    }
  }
}

}  // namespace
}  // namespace carousel::scene

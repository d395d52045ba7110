#include <limits>

#include "scene/gltf/bounded_import.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

const std::vector<Vec3> kSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<std::uint32_t> kTwoTriangles = {0, 1, 2, 0, 2, 3};

template <class T>
GltfBuilder square_with_indices(int component) {
  GltfBuilder b;
  const int positions = b.square_positions();
  b.mesh({{"POSITION", positions}}, b.accessor(b.view(std::vector<T>{0, 1, 2, 0, 2, 3}), component, 6, "SCALAR"));
  return b;
}

TEST(GltfAccessor, ReadsEveryIndexType) {
  for (const GltfBuilder& b : {square_with_indices<std::uint8_t>(5121), square_with_indices<std::uint16_t>(5123),
                               square_with_indices<std::uint32_t>(5125)}) {
    const Scene scene = b.load();
    EXPECT_EQ(scene.meshes[0].indices, kTwoTriangles);
    EXPECT_EQ(scene.meshes[0].positions, kSquare);
    EXPECT_TRUE(scene.meshes[0].normals.empty());
  }
}

TEST(GltfAccessor, ReadsNonIndexedTriangles) {
  GltfBuilder b;
  b.mesh({{"POSITION", b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}});
  EXPECT_EQ(b.load().meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(GltfAccessor, StripsAndFansBecomeListsWithTheirWinding) {
  GltfBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3", 3);
  b.mesh({{"POSITION", p}}, -1, {{"mode", 5}});
  b.mesh({{"POSITION", p}}, -1, {{"mode", 6}});
  const Scene scene = b.load();
  EXPECT_EQ(scene.meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  EXPECT_EQ(scene.meshes[1].indices, (std::vector<std::uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0}));
}

TEST(GltfAccessor, ReadsInterleavedStridedAttributes) {
  GltfBuilder b;
  // position, normal, position, normal ... with 4 bytes of padding
  std::vector<float> data;
  for (const Vec3& p : kSquare) data.insert(data.end(), {p.x, p.y, p.z, 0, 0, 2, -99});
  const int view = b.view(data, 28);
  const int positions = b.accessor(view, 5126, 4, "VEC3"), normals = b.accessor(view, 5126, 4, "VEC3", false, 12);
  b.mesh({{"POSITION", positions}, {"NORMAL", normals}},
         b.accessor(b.view(std::vector<std::uint8_t>{0, 1, 2}), 5121, 3, "SCALAR"));
  const Scene scene = b.load();
  EXPECT_EQ(scene.meshes[0].positions, kSquare);
  EXPECT_EQ(scene.meshes[0].normals, std::vector<Vec3>(4, Vec3(0, 0, 1)));  // made unit
}

TEST(GltfAccessor, SparseReplacesElementsOfTheBase) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint16_t>{1, 3}), values = b.view(std::vector<float>{5, 6, 7, 8, 9, 10});
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(b.load().meshes[0].positions, (std::vector<Vec3>{{0, 0, 0}, {5, 6, 7}, {1, 1, 0}, {8, 9, 10}}));
}

// Others reported this kind of fault: godot 76875, DiligentFX 265.
TEST(GltfAccessor, SparseWithoutABaseStartsFromZeros) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{2}), values = b.view(std::vector<float>{5, 6, 7});
  b.json["accessors"][0].erase("bufferView");
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(b.load().meshes[0].positions, (std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {5, 6, 7}, {0, 0, 0}}));
}

// Others reported this kind of fault: godot 76875, DiligentFX 265.
TEST(GltfAccessor, SparseIndicesWithoutABaseAreRead) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{1, 2}), values = b.view(std::vector<std::uint16_t>{1, 2});
  b.json["accessors"][1].erase("bufferView");
  b.json["accessors"][1]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  EXPECT_EQ(b.load().meshes[0].indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 0, 0}));
}

TEST(GltfAccessor, NormalisedIntegersAreExactQuotients) {
  GltfBuilder b = GltfBuilder::square();
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_0"] =
      b.accessor(b.view(std::vector<std::uint16_t>{0, 65535, 1, 2, 3, 4, 5, 6}), 5123, 4, "VEC2", true);
  attributes["TEXCOORD_1"] = b.accessor(
      b.view(std::vector<std::uint8_t>{0, 255, 0, 0, 1, 2, 0, 0, 3, 4, 0, 0, 5, 6, 0, 0}, 4), 5121, 4, "VEC2", true);
  attributes["COLOR_0"] =
      b.accessor(b.view(std::vector<std::uint8_t>{255, 0, 51, 0, 255, 0, 51, 0, 255, 0, 51, 0, 255, 0, 51, 0}, 4), 5121,
                 4, "VEC3", true);
  const Mesh mesh = b.load().meshes[0];
  EXPECT_EQ(mesh.uv0[0], Vec2(0, 1));
  EXPECT_EQ(mesh.uv0[1], Vec2(1.0f / 65535.0f, 2.0f / 65535.0f));
  EXPECT_EQ(mesh.uv1[1], Vec2(1.0f / 255.0f, 2.0f / 255.0f));
  EXPECT_EQ(mesh.colors[0], Vec4(1, 0, 51.0f / 255.0f, 1));  // VEC3 gets alpha 1
}

TEST(GltfAccessor, QuantisedPositionsAndNormals) {
  GltfBuilder b;
  b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const int positions =
      b.accessor(b.view(std::vector<std::int16_t>{-32768, 0, 7, 0, 100, 200, -300, 0, 1, 2, 3, 0}, 8), 5122, 3, "VEC3");
  const int normals = b.accessor(b.view(std::vector<std::int8_t>{0, 0, 127, 0, 0, -128, 0, 0, -127, 0, 0, 0}, 4), 5120,
                                 3, "VEC3", true);
  b.mesh({{"POSITION", positions}, {"NORMAL", normals}});
  const Mesh mesh = b.load().meshes[0];
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{-32768, 0, 7}, {100, 200, -300}, {1, 2, 3}}));
  EXPECT_EQ(mesh.normals, (std::vector<Vec3>{{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}}));
}

TEST(GltfAccessor, RefusesQuantisedPositionsWithoutTheExtension) {
  GltfBuilder b;
  b.mesh({{"POSITION", b.accessor(b.view(std::vector<std::int16_t>(12), 8), 5122, 3, "VEC3")}});
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION", "needs the extension KHR_mesh_quantization");
}

TEST(GltfAccessor, RefusesIndexBeyondPositions) {
  GltfBuilder b = square_with_indices<std::uint16_t>(5123);
  b.json["accessors"][0]["count"] = 3;
  expect_refused(b, "/meshes/0/primitives/0/indices", "index 3 at position 5 is beyond the 3 positions");
}

TEST(GltfAccessor, RefusesAccessorLongerThanItsView) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][0]["count"] = 5;
  expect_refused(b, "/accessors/0",
                 "5 elements of 12 bytes, 12 bytes apart, from byte 0 on reach outside buffer view 0, which "
                 "has 48 bytes");
}

TEST(GltfAccessor, RefusesHugeCountsWithoutAllocating) {
  for (const double count : {4e9, 9007199254740992.0}) {
    GltfBuilder b = GltfBuilder::square();
    b.json["accessors"][0]["count"] = count;
    expect_refused(b, "/accessors/0", "reach outside buffer view 0");
  }
}

TEST(GltfAccessor, RefusesCountsBeyondAnyFile) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][0]["count"] = 1e18;
  expect_refused(b, "/accessors/0/count", "expected an integer of at least 1");
}

TEST(GltfAccessor, RefusesZerosThatNothingJustifies) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][0].erase("bufferView");
  b.json["accessors"][0]["count"] = 4000000000u;
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION", "asks for 4000000000 elements and stores 0");
}

TEST(GltfAccessor, RefusesSparseZerosThatNothingJustifies) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{2}), values = b.view(std::vector<float>{5, 6, 7});
  b.json["accessors"][0].erase("bufferView");
  b.json["accessors"][0]["count"] = 4000000000u;
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION", "asks for 4000000000 elements and stores 1");
}

TEST(GltfAccessor, RefusesManyMeshesThatMultiplyOneAccessor) {
  GltfBuilder b;
  const int positions = b.accessor(-1, 5126, 65535, "VEC3");  // all zero, no bytes
  for (int i = 0; i < 200; ++i) b.mesh({{"POSITION", positions}});
  // 20 bytes a vertex or more stay of each mesh.
  expect_scene_error([&] { load_gltf_within(13 << 20, b.glb(), "x.glb"); },
                     "/meshes/9/primitives/0/attributes/POSITION", "(engine.memory_limit_mib)");
}

TEST(GltfAccessor, RefusesSparseIndexBeyondTheCount) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{4}), values = b.view(std::vector<float>{5, 6, 7});
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  expect_refused(b, "/accessors/0/sparse/indices", "index 4 at position 0 is beyond the accessor's 4 elements");
}

TEST(GltfAccessor, RefusesSparseIndicesThatDoNotIncrease) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{2, 2}), values = b.view(std::vector<float>(6));
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  expect_refused(b, "/accessors/0/sparse/indices", "must increase");
}

TEST(GltfAccessor, RefusesSparseValuesOutsideTheirView) {
  GltfBuilder b = GltfBuilder::square();
  const int indices = b.view(std::vector<std::uint8_t>{1, 2}), values = b.view(std::vector<float>(3));
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", values}}}};
  expect_refused(b, "/accessors/0/sparse/values", "reach outside buffer view 3");
}

TEST(GltfAccessor, RefusesNaNPositions) {
  GltfBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  b.mesh({{"POSITION", b.floats({0, 0, 0, 1, nan, 0, 0, 1, 0}, "VEC3", 3)}});
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION", "component 1 of element 1 of accessor 0 is NaN");
  GltfBuilder c;
  c.mesh({{"POSITION", c.floats({0, 0, 0, 1, 0, -inf, 0, 1, 0}, "VEC3", 3)}});
  expect_refused(c, "/meshes/0/primitives/0/attributes/POSITION", "component 2 of element 1 of accessor 0 is infinite");
}

TEST(GltfAccessor, RefusesWrongElementAndComponentTypes) {
  GltfBuilder b;
  b.mesh({{"POSITION", b.floats({0, 0, 1, 0, 0, 1}, "VEC2", 2)}});
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION",
                 "expected VEC3 elements; accessor 0 has VEC2 of FLOAT");
  GltfBuilder c;
  const int positions = c.square_positions();
  c.mesh({{"POSITION", positions}}, c.floats({0, 1, 2}, "SCALAR", 1));
  expect_refused(c, "/meshes/0/primitives/0/indices",
                 "the component type is not allowed here: accessor 1 has SCALAR of FLOAT");
}

TEST(GltfAccessor, RefusesAttributesOfDifferentLength) {
  GltfBuilder b = GltfBuilder::square();
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.floats({0, 0, 1}, "VEC3", 3);
  expect_refused(b, "/meshes/0/primitives/0/attributes/NORMAL", "accessor 2 has 1 elements, POSITION has 4");
}

TEST(GltfAccessor, RefusesStrideBelowTheElementSize) {
  GltfBuilder b = GltfBuilder::square();
  b.json["bufferViews"][0]["byteStride"] = 8;
  expect_refused(b, "/accessors/0", "elements of 12 bytes do not fit the stride of 8");
  b.json["bufferViews"][0]["byteStride"] = 14;
  expect_refused(b, "/bufferViews/0/byteStride", "expected a multiple of 4, found 14");
}

TEST(GltfAccessor, RefusesTriangleListsThatAreCutOff) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][1]["count"] = 5;
  expect_refused(b, "/meshes/0/primitives/0/indices", "multiple of 3 vertices, found 5");
}

}  // namespace
}  // namespace carousel::scene

// Extensions that decide what of a file is shown, and which of two sources is read.
#include "scene/builtin/mesh_shapes.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/scene/gltf/packed_model.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

Json visibility(bool visible) {
  return {{"KHR_node_visibility", {{"visible", visible}}}};
}

// Others reported this kind of fault: glTFast 112.
TEST(GltfVisibility, HiddenNodesTakeAllBelowThemAway) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_node_visibility"};
  const auto shape = [&](double x, const Json& extensions) {
    return b.push("nodes", {{"mesh", 0}, {"translation", {x, 0, 0}}, {"extensions", extensions}});
  };
  const int below = shape(1, visibility(true));  // visible by itself, and below a hidden node
  b.node({{"children", {below}}, {"mesh", 0}, {"extensions", visibility(false)}});
  const int beside = shape(2, Json::object()), hidden = shape(3, visibility(false));
  b.node({{"children", {beside, hidden}}, {"extensions", visibility(true)}});
  std::vector<std::string> warnings;
  const Scene scene = b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(warnings, std::vector<std::string>{});
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.instances[0].world_from_model.translation, Vec3(0));
  EXPECT_EQ(scene.instances[1].world_from_model.translation, Vec3(2, 0, 0));
}

TEST(GltfVisibility, HidesLightsSpheresAndInstancesAndNoCameras) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
  b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  const int places = b.floats({0, 0, 0, 1, 1, 1}, "VEC3", 3);
  const Json instancing = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}};
  const Json light = {{"KHR_lights_punctual", {{"light", 0}}}};
  const int lamp = b.push("nodes", {{"extensions", light}}), eye = b.push("nodes", {{"camera", 0}});
  const int many = b.push("nodes", {{"mesh", 0}, {"extensions", instancing}});
  const int ball = b.push("nodes", {{"extras", {{"carousel_sphere", {{"radius", 1}}}}}});
  const int top = b.node({{"children", {lamp, eye, many, ball}}});
  const Scene shown = b.load();
  EXPECT_EQ(shown.lights.size(), 1u);
  EXPECT_EQ(shown.instances.size(), 4u);
  b.json["nodes"][static_cast<std::size_t>(top)]["extensions"] = visibility(false);
  const Scene hidden = b.load();
  EXPECT_EQ(hidden.lights.size(), 0u);
  EXPECT_EQ(hidden.instances.size(), 1u);
  ASSERT_EQ(hidden.cameras.size(), 1u);
  EXPECT_FALSE(hidden.added.camera);
}

TEST(GltfVisibility, SceneOfHiddenNodesShowsNothingAndOtherValuesAreRefused) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["extensions"] = visibility(false);
  expect_refused(b, "", "shows no triangles");
  b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = 0;
  expect_refused(b, "/nodes/0/extensions/KHR_node_visibility/visible", "expected");
}

// A scale of 0 is a common way to hide a node. It leaves a point light as it is, and a spot or a sun no direction.
// Others reported this kind of fault: three-mesh-bvh 794, glTF 985.
TEST(GltfLight, FlattenedByTheirNodesAreLeftOutWithAWarning) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "point"}}, {{"type", "spot"}, {"spot", Json::object()}}, {{"type", "directional"}}});
  const auto light = [](int i) { return Json{{"KHR_lights_punctual", {{"light", i}}}}; };
  for (int i = 0; i < 3; ++i) b.node({{"scale", {0, 0, 0}}, {"extensions", light(i)}});
  b.node({{"scale", {0, 0, 2}}, {"extensions", light(2)}});  // the direction is left
  std::vector<std::string> warnings;
  const Scene scene = b.load([&](const std::string& w) { warnings.push_back(w); });
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].kind, PunctualLight::Kind::kPoint);
  EXPECT_EQ(scene.lights[1].direction, Vec3(0, 0, -1));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0], "test.gltf: /nodes/2: the light is left out, since its node's scale leaves it no direction");
  EXPECT_EQ(warnings[1], "test.gltf: /nodes/3: the light is left out, since its node's scale leaves it no direction");
}

// The plain data beside a stream is for readers that do not know the extension. A file that requires it has none such.
TEST(GltfDraco, RequiredStreamsAreReadThoughThereIsPlainData) {
  GltfBuilder b = GltfBuilder::square();
  const int view = b.view(std::vector<char>(100, 'x'));
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  EXPECT_NO_THROW(b.load());
  b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  expect_refused(b, "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression",
                 "not a mesh of Draco bitstream 2.2");

  GltfBuilder good;
  Mesh ball;
  add_icosphere(ball, Vec3(0), 1, 1, MaterialId(0));
  draco_mesh(good, ball, true);
  const Scene packed = good.load();
  for (const char* name : {"POSITION", "NORMAL"}) {  // zeros, which the stream's data replaces
    const auto accessor = good.json["meshes"][0]["primitives"][0]["attributes"][name].get<std::size_t>();
    const auto count = good.json["accessors"][accessor]["count"].get<std::size_t>();
    good.json["accessors"][accessor]["bufferView"] = good.view(std::vector<float>(3 * count));
  }
  const auto indices = good.json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>();
  good.json["accessors"][indices]["bufferView"] = good.view(std::vector<std::uint16_t>(240));
  good.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_EQ(good.load().meshes[0].positions, packed.meshes[0].positions);
  EXPECT_EQ(good.load().meshes[0].indices, packed.meshes[0].indices);
}

}  // namespace
}  // namespace carousel::scene

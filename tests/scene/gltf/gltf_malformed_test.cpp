// Malformed documents: text, versions, extensions, node graphs, indices, types and keys.
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

void expect_text_refused(const std::string& text, const std::string& path, const std::string& message) {
  expect_scene_error([&] { GltfBuilder::load_text(text); }, path, message);
}

std::string with_extras(const std::string& extras) {
  std::string text = GltfBuilder::square().text();
  text.insert(1, "\"extras\":" + extras + ",");
  return text;
}

TEST(GltfMalformed, EmptyAndGarbage) {
  expect_text_refused("", "", "the file is empty");
  expect_text_refused("hello", "", "not a glTF file: parse error at line 1");
  expect_text_refused("[1, 2]", "", "expected a JSON object");
  expect_text_refused("{\"asset\":", "", "parse error");
  expect_text_refused("{\"asset\": {\"version\": \"2.0\"}, \"scene\": 1e999}", "", "number overflow");
}

TEST(GltfMalformed, DeeplyNestedExtrasDoNotOverflowTheStack) {
  const std::size_t deep = 300000;
  expect_text_refused(with_extras(std::string(deep, '[') + std::string(deep, ']')), "/extras/0/0/0/0/0",
                      "nested more than 128 levels deep");
  std::string objects;
  for (std::size_t i = 0; i < deep; ++i) objects += "{\"a\":";
  expect_text_refused(with_extras(objects), "/extras/a/a/a/a/a", "nested more than 128 levels deep");
  // Brackets inside strings do not count as nesting.
  EXPECT_NO_THROW(GltfBuilder::load_text(with_extras('"' + std::string(deep, '[') + "\\\"{\"")));
  EXPECT_NO_THROW(GltfBuilder::load_text(with_extras(std::string(100, '[') + std::string(100, ']'))));
}

TEST(GltfMalformed, OtherVersions) {
  GltfBuilder b = GltfBuilder::square();
  b.json["asset"]["version"] = "1.0";
  expect_refused(b, "/asset/version", "glTF version \"1.0\"; only 2.0 is read");
  b.json["asset"] = {{"version", "2.1"}, {"minVersion", "2.1"}};
  expect_refused(b, "/asset/minVersion", "glTF version \"2.1\"");
  b.json["asset"] = {{"version", 2}};
  expect_refused(b, "/asset/version", "expected a string");
  b.json.erase("asset");
  expect_refused(b, "/asset", "missing");
  // Version 1 files keep objects where version 2 has arrays; the version is named before those.
  expect_text_refused(R"({"asset": {"version": "1.1"}, "meshes": {"box": {}}})", "/asset/version", "\"1.1\"");
}

// Others reported this kind of fault: glTFast 112.
TEST(GltfMalformed, RequiredExtensionIsRefusedByName) {
  for (const char* name : {"KHR_texture_basisu", "VENDOR_unheard_of"}) {
    GltfBuilder b = GltfBuilder::square();
    b.json["extensionsRequired"] = {"KHR_texture_transform", name};
    expect_refused(b, "/extensionsRequired/1", std::string("the file requires ") + name);
  }
}

// Others reported this kind of fault: glTFast 112.
TEST(GltfMalformed, OptionalExtensionIsIgnoredWithOneWarning) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"KHR_materials_dispersion", "KHR_materials_unlit", "VENDOR_unheard_of"};
  b.push("materials", {{"extensions", {{"KHR_materials_dispersion", {{"dispersion", "nonsense"}}}}}});
  std::vector<std::string> warnings;
  b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(warnings, std::vector<std::string>{
                          "test.gltf: optional extensions ignored: KHR_materials_dispersion, VENDOR_unheard_of"});
}

TEST(GltfMalformed, SkinsMorphTargetsAndAnimationsAreIgnoredWithOneWarning) {
  GltfBuilder b = GltfBuilder::square();
  b.json["skins"] = Json::array({{{"joints", {0}}}});
  b.json["nodes"][0]["skin"] = 0;
  b.json["meshes"][0]["primitives"][0]["targets"] = Json::array({{{"POSITION", 0}}});
  std::vector<std::string> warnings;
  b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(warnings, std::vector<std::string>{"test.gltf: ignored, the base pose is shown: skins, morph targets"});
}

TEST(GltfMalformed, FallbackBuffersAreOnlyForReadersThatCannotUnpack) {
  GltfBuilder b = GltfBuilder::square();
  b.json["buffers"] =
      Json::array({{{"byteLength", 60}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}});
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION",
                 "the data of accessor 0 is not in the file: buffer 0 holds none");
}

TEST(GltfMalformed, NodeCycles) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  b.json["nodes"][0]["children"] = {0};
  expect_refused(b, "/nodes/0/children/0", "node 0 is its own child: the nodes form a cycle");
  b.json["nodes"][0]["children"] = {1};
  b.push("nodes", {{"children", {2}}});
  b.push("nodes", {{"children", {0}}});
  expect_refused(b, "/nodes/0/children", "node 1 is its own ancestor: the nodes form a cycle");
}

TEST(GltfMalformed, SeveralParents) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  b.node({{"children", {0}}});
  b.node({{"children", {0}}});
  expect_refused(b, "/nodes/2/children/0", "node 0 has several parents: node 1 and node 2");
}

TEST(GltfMalformed, OutOfRangeIndicesOfEveryKind) {
  const auto refuse = [](const std::string& pointer, const Json& value, const std::string& array,
                         const std::string& size) {
    GltfBuilder b = GltfBuilder::square();
    b.push("materials", {{"normalTexture", {{"index", 0}}}});
    b.push("textures", {{"source", 0}, {"sampler", 0}});
    b.push("samplers", Json::object());
    b.push("images", {{"bufferView", 0}});
    b.push("skins", {{"joints", {0}}, {"skeleton", 0}, {"inverseBindMatrices", 0}});
    b.push("animations", {{"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})},
                          {"samplers", Json::array({{{"input", 0}, {"output", 0}}})}});
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
    b.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}},
                                        {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 0}}}}}};
    b.json["accessors"][0]["sparse"] = {
        {"count", 1}, {"indices", {{"bufferView", 0}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
    b.json[Json::json_pointer(pointer)] = value;
    expect_refused(b, pointer, "expected an index into " + array + ", which has " + size + ", found " + value.dump());
  };
  for (const Json& bad : {Json(99), Json(-1), Json(1.5), Json(4294967296.0 * 4)}) {
    refuse("/scene", bad, "/scenes", "1 entry");
    refuse("/scenes/0/nodes/0", bad, "/nodes", "1 entry");
    refuse("/nodes/0/mesh", bad, "/meshes", "1 entry");
    refuse("/nodes/0/skin", bad, "/skins", "1 entry");
    refuse("/nodes/0/camera", bad, "/cameras", "0 entries");
    refuse("/nodes/0/extensions/KHR_lights_punctual/light", bad, "/extensions/KHR_lights_punctual/lights", "1 entry");
    refuse("/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION", bad, "/accessors", "2 entries");
    refuse("/meshes/0/primitives/0/indices", bad, "/accessors", "2 entries");
    refuse("/meshes/0/primitives/0/material", bad, "/materials", "1 entry");
    refuse("/meshes/0/primitives/0/attributes/POSITION", bad, "/accessors", "2 entries");
    refuse("/accessors/0/bufferView", bad, "/bufferViews", "2 entries");
    refuse("/accessors/0/sparse/indices/bufferView", bad, "/bufferViews", "2 entries");
    refuse("/accessors/0/sparse/values/bufferView", bad, "/bufferViews", "2 entries");
    refuse("/bufferViews/0/buffer", bad, "/buffers", "1 entry");
    refuse("/materials/0/normalTexture/index", bad, "/textures", "1 entry");
    refuse("/textures/0/source", bad, "/images", "1 entry");
    refuse("/textures/0/sampler", bad, "/samplers", "1 entry");
    refuse("/images/0/bufferView", bad, "/bufferViews", "2 entries");
  }
}

TEST(GltfMalformed, ChildOutOfRange) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["children"] = {5};
  expect_refused(b, "/nodes/0/children/0", "expected an index into /nodes, which has 1 entry, found 5");
}

TEST(GltfMalformed, WrongTypes) {
  const auto refuse = [](const std::string& pointer, const Json& value, const std::string& message) {
    GltfBuilder b = GltfBuilder::square();
    b.push("materials", Json::object());
    b.json[Json::json_pointer(pointer)] = value;
    expect_refused(b, pointer, message);
  };
  refuse("/nodes", 5, "expected an array, found 5");
  refuse("/nodes/0", "x", "expected an object, found \"x\"");
  refuse("/meshes", Json::object(), "expected an array, found an object");
  refuse("/meshes/0/primitives", nullptr, "expected an array, found null");
  refuse("/meshes/0/primitives/0/attributes", Json::array(), "expected an object, found an array of 0");
  refuse("/meshes/0/primitives/0/mode", 7, "expected an integer from 0 to 6, found 7");
  refuse("/accessors/0/componentType", 5124, "expected one of 5120 5121 5122 5123 5125 5126, found 5124");
  refuse("/accessors/0/type", "VEC5", "expected one of SCALAR VEC2");
  refuse("/accessors/0/count", -3, "expected an integer of at least 1, found -3");
  refuse("/accessors/0/count", "many", "expected an integer of at least 1, found \"many\"");
  refuse("/accessors/0/normalized", 1, "expected true or false");
  refuse("/nodes/0/matrix", Json::array({1, 2}), "expected an array of 16 numbers, found an array of 2");
  refuse("/nodes/0/name", 7, "expected a string");
  refuse("/nodes/0/translation", Json::array({1, 2, 3, 4}), "expected an array of 3 numbers");
  refuse("/materials/0/alphaMode", "SOLID", "expected one of OPAQUE MASK BLEND");
  refuse("/extensionsUsed", Json::object(), "expected an array");
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["scale"] = {1, 1e300, 1};
  expect_refused(b, "/nodes/0/scale/1", "expected a number from");
  b.json["nodes"][0]["scale"] = {1, "big", 1};
  expect_refused(b, "/nodes/0/scale/1", "expected a number, found \"big\"");
}

TEST(GltfMalformed, WholeNumbersMayBeWrittenWithAPoint) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][0]["count"] = 4.0;
  b.json["nodes"][0]["mesh"] = 0.0;
  EXPECT_NO_THROW(b.load());
}

TEST(GltfMalformed, MissingKeys) {
  GltfBuilder b = GltfBuilder::square();
  b.json["accessors"][0].erase("componentType");
  expect_refused(b, "/accessors/0/componentType", "missing");
  b = GltfBuilder::square();
  b.json["meshes"][0]["primitives"][0].erase("attributes");
  expect_refused(b, "/meshes/0/primitives/0/attributes", "missing");
}

}  // namespace
}  // namespace carousel::scene

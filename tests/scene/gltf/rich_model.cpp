#include "tests/scene/gltf/rich_model.h"

#include "scene/builtin/mesh_shapes.h"
#include "tests/scene/gltf/encode_image.h"

namespace carousel::scene {

namespace {

using Json = nlohmann::json;

std::vector<unsigned char> png(int size) {
  std::vector<unsigned char> pixels(static_cast<std::size_t>(size * size * 3));
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<unsigned char>(i * i);
  return encode_png(size, size, 3, pixels);
}

template <class V>
int vectors(GltfBuilder& b, const std::vector<V>& values, const char* type) {
  std::vector<float> floats;
  for (const V& v : values)
    for (int c = 0; c < V::length(); ++c) floats.push_back(v[c]);
  return b.floats(floats, type, static_cast<std::size_t>(V::length()));
}

/// Adds a node that shows the mesh; returns its index. The mesh is like an exporter's: u16 indices, smooth
/// normals.
int add_shape(GltfBuilder& b, const Mesh& shape, const Json& attributes) {
  Json all = attributes;
  all["POSITION"] = vectors(b, shape.positions, "VEC3");
  all["NORMAL"] = vectors(b, shape.normals, "VEC3");
  const std::vector<std::uint16_t> indices(shape.indices.begin(), shape.indices.end());
  b.mesh(all, b.accessor(b.view(indices), 5123, indices.size(), "SCALAR"), {{"material", 0}});
  return static_cast<int>(b.json["nodes"].size()) - 1;
}

void add_crowd(GltfBuilder& b, int node) {
  std::vector<float> translations, scales;
  std::vector<std::int16_t> rotations;
  for (int i = 0; i < 24; ++i) {
    const float f = static_cast<float>(i);
    translations.insert(translations.end(), {f, f * f, -f});
    scales.insert(scales.end(), {1, 1 + f, i % 2 == 0 ? 1.0f : -1.0f});
    rotations.insert(rotations.end(), {0, 0, static_cast<std::int16_t>(1000 * i), 32767});
  }
  b.json["nodes"][static_cast<std::size_t>(node)]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.floats(translations, "VEC3", 3)},
      {"SCALE", b.floats(scales, "VEC3", 3)},
      {"ROTATION", b.accessor(b.view(rotations), 5122, 24, "VEC4", true)}};
}

/// Views go to the two files in turn.
void split_buffers(const GltfBuilder& from, ModelFiles& to) {
  const char* const names[] = {"even.bin", "odd.bin"};
  Json& views = to.json["bufferViews"];
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::string& file = to.files[names[i % 2]];
    file.resize((file.size() + 3) / 4 * 4);
    const auto* first = reinterpret_cast<const char*>(from.binary.data()) + views[i]["byteOffset"].get<std::size_t>();
    views[i]["buffer"] = i % 2;
    views[i]["byteOffset"] = file.size();
    file.append(first, views[i]["byteLength"].get<std::size_t>());
  }
  for (const char* name : names) to.json["buffers"].push_back({{"uri", name}, {"byteLength", to.files[name].size()}});
}

}  // namespace

GltfBuilder every_feature() {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", "KHR_lights_punctual", "VENDOR_x"};
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  b.push("images", {{"bufferView", b.view(png(4))}, {"mimeType", "image/png"}});
  b.push("samplers", {{"wrapS", 33071}});
  b.push("textures", {{"source", 0}, {"sampler", 0}});
  b.push(
      "materials",
      {{"pbrMetallicRoughness",
        {{"baseColorTexture",
          {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 1}}, {"texCoord", 0}}}}}}},
         {"metallicFactor", 0.5}}},
       {"emissiveFactor", {1, 1, 1}},
       {"alphaMode", "BLEND"},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}}, {"VENDOR_x", {{"deep", {{"er", {1, 2}}}}}}}}});
  Json& primitive = b.json["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_0"] =
      b.accessor(b.view(std::vector<std::uint16_t>(8, 1000)), 5123, 4, "VEC2", true);
  primitive["attributes"]["COLOR_0"] = b.accessor(b.view(std::vector<std::uint8_t>(16, 200)), 5121, 4, "VEC4", true);
  const int sparse_indices = b.view(std::vector<std::uint8_t>{1, 3}), sparse_values = b.view(std::vector<float>(6, 2));
  b.json["accessors"][0]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", sparse_indices}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", sparse_values}}}};
  const int small =
      b.accessor(b.view(std::vector<std::int16_t>{0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0, 0}, 8), 5122, 3, "VEC3");
  b.mesh({{"POSITION", small}}, -1, {{"mode", 5}});
  const int translations = b.floats({1, 0, 0, 2, 0, 0}, "VEC3", 3);
  b.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations}};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}, {{"type", "point"}}});
  b.node({{"rotation", {0, 0, 0, 1}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  const int inner = b.push("nodes", {{"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 5, 5, 1}}});
  b.node({{"children", {inner}}, {"scale", {-1, 2, 1}}});
  b.push("animations", {{"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}})},
                        {"samplers", Json::array({{{"input", 0}, {"output", 0}}})}});
  b.json["scene"] = 0;
  return b;
}

ModelFiles rich_model() {
  GltfBuilder b = every_feature();
  Mesh torus, ball;
  add_torus(torus, 2, 0.5f, 24, 12, MaterialId(0));
  add_icosphere(ball, Vec3(0), 1, 2, MaterialId(0));
  const int uv = b.floats(std::vector<float>(2 * torus.positions.size(), 0.25f), "VEC2", 2);
  const int torus_node = add_shape(b, torus, {{"TEXCOORD_0", uv}});
  add_crowd(b, add_shape(b, ball, Json::object()));

  Json& primitive = b.json["meshes"].back()["primitives"][0];
  primitive["targets"] = Json::array({{{"POSITION", primitive["attributes"]["POSITION"]}}});
  std::vector<float> identity(16);
  for (std::size_t i = 0; i < 4; ++i) identity[5 * i] = 1;
  b.push("skins",
         {{"joints", {torus_node}}, {"skeleton", torus_node}, {"inverseBindMatrices", b.floats(identity, "MAT4", 16)}});
  b.json["nodes"][static_cast<std::size_t>(torus_node)]["skin"] = 0;
  b.push("cameras",
         {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"znear", 0}, {"zfar", 9}}}});
  const int eye = b.push("nodes", {{"camera", 1}, {"translation", {0, 1, 9}}});
  b.node({{"rotation", {0, 0.6, 0, 0.8}}, {"children", {eye}}});
  b.push("textures", {{"source", b.push("images", {{"uri", "noise.png"}})}, {"sampler", 0}});
  b.json["materials"][0]["normalTexture"] = {{"index", 1}, {"scale", 0.5}};

  ModelFiles out;
  out.json = b.json;
  split_buffers(b, out);
  const std::vector<unsigned char> noise = png(32);
  out.files["noise.png"] = std::string(noise.begin(), noise.end());
  return out;
}

ModelFiles sample_model() {
  return ModelFiles::read(CAROUSEL_SOURCE_DIR "/tests/data/texture_transform_test/TextureTransformTest.gltf");
}

}  // namespace carousel::scene

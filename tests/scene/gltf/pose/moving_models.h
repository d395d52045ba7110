#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {

/// Loads the file at a moment.
inline Scene load_at(const GltfBuilder& builder, float seconds, std::optional<std::string> animation = {},
                     const WarningSink& warn = {}) {
  const std::string text = builder.text();
  return load_gltf_from_memory(std::as_bytes(std::span(text)), "test.gltf", warn, {},
                               PoseChoice{seconds, std::move(animation)});
}

/// A new animation with one channel: `keys` hold `width` numbers each for every time. Returns its index.
inline int animate(GltfBuilder& b, int node, const std::string& path, const std::vector<float>& times,
                   const std::vector<float>& keys, const char* type, std::size_t width,
                   const std::string& interpolation = "LINEAR", const std::string& name = "") {
  GltfBuilder::Json animation;
  if (!name.empty()) animation["name"] = name;
  const int input = b.floats(times, "SCALAR", 1), output = b.floats(keys, type, width);
  const GltfBuilder::Json sampler = {{"input", input}, {"output", output}, {"interpolation", interpolation}};
  const GltfBuilder::Json channel = {{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}};
  animation["samplers"].push_back(sampler);
  animation["channels"].push_back(channel);
  return b.push("animations", animation);
}

/// An arm of two bones along y, of length 1 each, that lies in the plane z = 0: its vertices are at the heights 0, 1
/// and 2, at x = -0.2 and 0.2. Those at 1 follow both bones alike. Node 0 shows it, node 1 is the upper arm, node 2 the
/// forearm below it. Animation 0, "bend", turns the forearm by 90 degrees to the left within a second.
inline GltfBuilder two_bone_arm() {
  GltfBuilder b;
  const float w = 0.2f;
  const int positions = b.floats({-w, 0, 0, w, 0, 0, -w, 1, 0, w, 1, 0, -w, 2, 0, w, 2, 0}, "VEC3", 3);
  const int normals = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0}, "VEC3", 3);
  const int indices =
      b.accessor(b.view(std::vector<std::uint16_t>{0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5}), 5123, 12, "SCALAR");
  const int joints = b.accessor(
      b.view(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), 5121,
      6, "VEC4");
  const int weights =
      b.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  b.mesh({{"POSITION", positions}, {"NORMAL", normals}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}, indices);
  b.json["nodes"][0]["skin"] = 0;
  b.json["nodes"][0]["name"] = "Arm";
  b.json["nodes"][0]["translation"] = {100, 0, 0};  // of no effect, since the joints place the mesh
  b.node({{"name", "Upper"}, {"children", {2}}});
  b.push("nodes", {{"name", "Fore"}, {"translation", {0, 1, 0}}});
  const int inverse = b.floats(
      {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1}, "MAT4", 16);
  b.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}});
  const float h = 0.70710678f;
  animate(b, 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, h, h}, "VEC4", 4, "LINEAR", "bend");
  return b;
}

/// The square of GltfBuilder::square() with two morph targets: the first lifts its corner (1, 1) by 2 along z, the
/// second moves all corners by 3 along x. Animation 0 raises the first weight from 0 to 1 within two seconds.
inline GltfBuilder morphed_square() {
  GltfBuilder b = GltfBuilder::square();
  // The lift is stored for the one corner that moves.
  const int lift = b.accessor(-1, 5126, 4, "VEC3");
  b.json["accessors"][static_cast<std::size_t>(lift)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", b.view(std::vector<std::uint8_t>{2})}, {"componentType", 5121}}},
      {"values", {{"bufferView", b.view(std::vector<float>{0, 0, 2})}}}};
  const int shift = b.floats({3, 0, 0, 3, 0, 0, 3, 0, 0, 3, 0, 0}, "VEC3", 3);
  b.json["meshes"][0]["primitives"][0]["targets"] =
      GltfBuilder::Json::array({{{"POSITION", lift}}, {{"POSITION", shift}}});
  animate(b, 0, "weights", {0, 2}, {0, 0, 1, 0}, "SCALAR", 1);
  return b;
}

}  // namespace carousel::scene

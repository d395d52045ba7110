#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/system/error.h"
#include "scene/gltf/import.h"

namespace carousel::scene {

/// Makes small glTF files in memory. `json` may be changed freely before it is written.
class GltfBuilder {
 public:
  using Json = nlohmann::json;

  GltfBuilder() { json = {{"asset", {{"version", "2.0"}}}}; }

  Json json;
  std::vector<std::byte> binary;

  /// The index of a new buffer view over a copy of `values`.
  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    while (binary.size() % 4 != 0) binary.push_back(std::byte{0});
    const std::size_t offset = binary.size(), size = values.size() * sizeof(T);
    binary.resize(offset + size);
    std::memcpy(binary.data() + offset, values.data(), size);
    Json entry = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}};
    if (stride != 0) entry["byteStride"] = stride;
    return push("bufferViews", entry);
  }

  int accessor(int buffer_view, int component, std::size_t count, const char* type, bool normalized = false,
               std::size_t offset = 0) {
    Json entry = {{"componentType", component}, {"count", count}, {"type", type}};
    if (buffer_view >= 0) entry["bufferView"] = buffer_view;
    if (normalized) entry["normalized"] = true;
    if (offset != 0) entry["byteOffset"] = offset;
    return push("accessors", entry);
  }

  int floats(const std::vector<float>& values, const char* type, std::size_t width) {
    return accessor(view(values), 5126, values.size() / width, type);
  }

  /// A new mesh of one primitive, and a root node of scene 0 that shows it.
  int mesh(Json attributes, int indices = -1, Json more = Json::object()) {
    Json primitive = std::move(more);
    primitive["attributes"] = std::move(attributes);
    if (indices >= 0) primitive["indices"] = indices;
    const int index = push("meshes", {{"primitives", Json::array({primitive})}});
    node({{"mesh", index}});
    return index;
  }

  /// A new root node of scene 0.
  int node(Json entry) {
    const int index = push("nodes", std::move(entry));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  int push(const char* array, Json entry) {
    json[array].push_back(std::move(entry));
    return static_cast<int>(json[array].size()) - 1;
  }

  /// Positions of a unit square's corners, 0 0, 1 0, 1 1, 0 1 in the plane z = 0.
  int square_positions() { return floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3); }

  /// One indexed square: accessor 0 positions, accessor 1 indices (u16), mesh 0, node 0.
  static GltfBuilder square() {
    GltfBuilder b;
    const int positions = b.square_positions();
    const int indices = b.accessor(b.view(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}), 5123, 6, "SCALAR");
    b.mesh({{"POSITION", positions}}, indices);
    return b;
  }

  /// The file as .gltf with the binary in a data: URI.
  std::string text() const {
    Json out = json;
    if (!binary.empty() && !out.contains("buffers")) {
      out["buffers"] = Json::array(
          {{{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}}});
    }
    return out.dump();
  }

  /// The file as .glb.
  std::vector<std::byte> glb() const {
    Json out = json;
    if (!binary.empty() && !out.contains("buffers")) out["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    std::string text = out.dump();
    while (text.size() % 4 != 0) text += ' ';
    std::vector<std::byte> padded = binary;
    while (padded.size() % 4 != 0) padded.push_back(std::byte{0});
    std::vector<std::byte> bytes;
    const auto word = [&](std::uint32_t v) {
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(v >> (8 * i)));
    };
    word(0x46546c67);
    word(2);
    word(static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + padded.size()));
    word(static_cast<std::uint32_t>(text.size()));
    word(0x4e4f534a);
    const auto* first = reinterpret_cast<const std::byte*>(text.data());
    bytes.insert(bytes.end(), first, first + text.size());
    word(static_cast<std::uint32_t>(padded.size()));
    word(0x004e4942);
    bytes.insert(bytes.end(), padded.begin(), padded.end());
    return bytes;
  }

  Scene load(const WarningSink& warn = {}) const { return load_text(text(), warn); }

  static Scene load_text(const std::string& text, const WarningSink& warn = {}) {
    return load_gltf_from_memory(std::as_bytes(std::span(text)), "test.gltf", warn);
  }

  static std::string base64(const std::vector<std::byte>& bytes) {
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      std::uint32_t bits = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        bits = bits << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0);
      }
      for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return out;
  }
};

/// Runs `load` and expects a SceneError at `path` whose message contains `message`.
inline void expect_scene_error(const std::function<void()>& load, const std::string& path, const std::string& message) {
  try {
    load();
    ADD_FAILURE() << "loaded without an error";
  } catch (const SceneError& e) {
    EXPECT_EQ(e.json_path(), path) << e.what();
    EXPECT_NE(e.message().find(message), std::string::npos) << e.what();
    EXPECT_FALSE(e.file().empty());
  }
}

inline void expect_refused(const GltfBuilder& builder, const std::string& path, const std::string& message) {
  expect_scene_error([&] { builder.load(); }, path, message);
}

}  // namespace carousel::scene

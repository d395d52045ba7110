#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {

/// A model on disk: the JSON of its .gltf, and the files beside it by their URIs.
struct ModelFiles {
  using Json = nlohmann::json;

  Json json;
  std::map<std::string, std::string> files;

  /// A .gltf and everything that its buffers and images name.
  static ModelFiles read(const std::filesystem::path& gltf) {
    ModelFiles out;
    out.json = Json::parse(content(gltf));
    for (const char* array : {"buffers", "images"}) {
      for (const Json& entry : out.json.value(array, Json::array())) {
        const std::string uri = entry.value("uri", "data:");
        if (!uri.starts_with("data:")) out.files[uri] = content(gltf.parent_path() / uri);
      }
    }
    return out;
  }

  void write(const std::filesystem::path& folder) const {
    std::ofstream(folder / "model.gltf", std::ios::binary) << json.dump();
    for (const auto& [uri, bytes] : files) std::ofstream(folder / uri, std::ios::binary) << bytes;
  }

  /// All of it in one .glb: buffers follow each other in the binary chunk, then the images in views of their
  /// own.
  GltfBuilder packed() const {
    GltfBuilder out;
    out.json = json;
    std::vector<std::size_t> start;
    for (const Json& buffer : json["buffers"]) {
      while (out.binary.size() % 4 != 0) out.binary.push_back(std::byte{0});
      start.push_back(out.binary.size());
      append(out.binary, files.at(buffer["uri"]));
    }
    for (Json& view : out.json["bufferViews"]) {
      view["byteOffset"] = view.value("byteOffset", std::size_t{0}) + start[view["buffer"].get<std::size_t>()];
      view["buffer"] = 0;
    }
    for (Json& image : out.json["images"]) {
      if (!image.contains("uri")) continue;
      std::vector<std::byte> bytes;
      append(bytes, files.at(image["uri"]));
      image = {{"bufferView", out.view(bytes)}, {"mimeType", "image/png"}};
    }
    out.json.erase("buffers");  // the builder names its own
    return out;
  }

  /// The file's bytes from element `index` of an accessor on.
  char* element(std::size_t accessor, std::size_t index) {
    const Json& a = json["accessors"][accessor];
    const Json& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
    const std::string uri = json["buffers"][view["buffer"].get<std::size_t>()]["uri"];
    const std::size_t stride = view.value("byteStride", element_size(a));
    return files.at(uri).data() + view.value("byteOffset", std::size_t{0}) + a.value("byteOffset", std::size_t{0}) +
           stride * index;
  }

 private:
  static std::string content(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in) << path;
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void append(std::vector<std::byte>& to, const std::string& from) {
    for (const char c : from) to.push_back(static_cast<std::byte>(c));
  }
  static std::size_t element_size(const Json& accessor) {
    const int component = accessor["componentType"];
    const std::string type = accessor["type"];
    const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type.back() - '0');
    return width * (component >= 5125 ? 4 : component >= 5122 ? 2 : 1);
  }
};

}  // namespace carousel::scene

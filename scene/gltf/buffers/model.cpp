#include "scene/gltf/buffers/model.h"

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

#include "core/system/error.h"
#include "scene/gltf/buffers/meshopt.h"
#include "scene/gltf/document/uses.h"

namespace carousel::scene {

namespace {

/// The data of tinygltf's callbacks. Addresses in the document it parses are "carousel-buffer-3" and
/// "carousel-image-0", so that it never opens a file itself.
struct Feed {
  std::vector<Bytes> buffers;
};

constexpr std::string_view kBufferAddress = "carousel-buffer-", kImageAddress = "carousel-image-";

bool read_address(Bytes* out, std::string*, const std::string& address, void* user) {
  Feed& feed = *static_cast<Feed*>(user);
  if (address.starts_with(kBufferAddress)) {
    *out = std::move(feed.buffers.at(std::stoul(address.substr(kBufferAddress.size()))));
    return true;
  }
  if (!address.starts_with(kImageAddress)) return false;
  *out = Bytes(1);
  return true;
}

/// Leaves the pixels to read_images().
bool take_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

/// The document with addresses replaced, and with a buffer view for every accessor: tinygltf requires one for indices,
/// though a sparse accessor may have none.
std::string text_for_tinygltf(const Json& checked, const std::vector<Bytes>& buffers) {
  Json json = checked;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    json["buffers"][i]["uri"] = std::string(kBufferAddress) + std::to_string(i);
    json["buffers"][i]["byteLength"] = buffers[i].size();
  }
  if (json.contains("images")) {
    const Uses uses = uses_of(checked);
    for (std::size_t i = 0; i < json["images"].size(); ++i) {
      Json& image = json["images"][i];
      if (!uses.images[i]) image = {{"uri", ""}};  // tinygltf would read it
      if (image.contains("uri")) image["uri"] = std::string(kImageAddress) + std::to_string(i);
    }
  }
  if (json.contains("accessors") && json.contains("bufferViews") && !json["bufferViews"].empty()) {
    for (Json& accessor : json["accessors"]) {
      if (!accessor.contains("bufferView")) accessor["bufferView"] = 0;
    }
  }
  if (json.contains("cameras")) {
    const Uses uses = uses_of(checked);
    for (std::size_t i = 0; i < json["cameras"].size(); ++i)
      if (!uses.cameras[i])
        json["cameras"][i] = {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}};
  }
  json.erase("skins");  // JointTable and pose_nodes() read these
  json.erase("animations");
  return json.dump();
}

/// True for a buffer that only readers without the meshopt extensions use.
bool is_fallback(const Json& buffer) {
  return std::ranges::any_of(kMeshoptExtensions, [&](const char* extension) {
    const Json::json_pointer pointer(std::string("/extensions/") + extension + "/fallback");
    return buffer.contains(pointer) && buffer.at(pointer).get<bool>();
  });
}

/// Checks that every image that is used and lies in a buffer view has its bytes there, before tinygltf reads them.
void check_embedded_images(const GltfDocument& document, const std::vector<bool>& has_data) {
  if (!document.json.contains("images")) return;
  const Json& images = document.json["images"];
  const Uses uses = uses_of(document.json);
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!uses.images[i] || !images[i].contains("bufferView")) continue;
    const Json& view = document.json["bufferViews"][images[i]["bufferView"].get<std::size_t>()];
    const std::string path = json_path(json_path("/images", i), "bufferView");
    if (!has_data[view["buffer"].get<std::size_t>()]) {
      document.fail(path, "the buffer holds no data");
    }
    if (view["byteLength"].get<std::uint64_t>() > 0x7fffffff) document.fail(path, "larger than 2 GiB");
  }
}

}  // namespace

GltfModel read_model(const GltfDocument& document, const GltfResources& resources) {
  GltfModel out;
  Feed feed;
  const std::size_t buffers = document.json.contains("buffers") ? document.json["buffers"].size() : 0;
  for (std::size_t i = 0; i < buffers; ++i) {
    std::optional<Bytes> bytes;
    if (!is_fallback(document.json["buffers"][i])) bytes = resources.buffer(i);
    out.buffer_has_data.push_back(bytes.has_value());
    feed.buffers.push_back(bytes ? std::move(*bytes) : Bytes(1));
    out.bytes_read += feed.buffers.back().size();
  }
  check_embedded_images(document, out.buffer_has_data);
  const std::string text = text_for_tinygltf(document.json, feed.buffers);
  if (text.size() > 0xffffffffu) document.fail("", "more than 4 GiB of JSON");

  tinygltf::TinyGLTF reader;
  reader.SetImageLoader(take_image, &feed);
  reader.SetFsCallbacks({[](const std::string&, void*) { return true; },
                         [](const std::string& name, void*) { return name; }, read_address, nullptr, &feed});
  std::string error, warning;
  try {
    if (reader.LoadASCIIFromString(&out.model, &error, &warning, text.data(), static_cast<unsigned int>(text.size()),
                                   "")) {
      return out;
    }
  } catch (const SceneError&) {
    throw;
  } catch (const std::exception& e) {
    error = e.what();
  }
  while (!error.empty() && error.back() == '\n') error.pop_back();
  document.fail("", "tinygltf: " + (error.empty() ? "cannot be read" : error));
}

}  // namespace carousel::scene

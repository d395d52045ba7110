// Khronos glTF 2.0 specification, 5.18 (image).
#include "scene/gltf/materials/images.h"

#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/system/stop_request.h"
#include "scene/images/image_decode.h"
#include "scene/images/read_at_once.h"

namespace carousel::scene {

namespace {

/// A name that ends as the picture's file would: of its file, or from its type, e.g. image/x-tga.
std::string name_of(const Json& image) {
  const std::string uri = image.value("uri", ""), type = image.value("mimeType", "");
  if (!uri.empty() && !uri.starts_with("data:")) return uri;
  const std::string from = uri.starts_with("data:") ? uri.substr(5, uri.find_first_of(";,") - 5) : type;
  return from.starts_with("image/") ? "image." + from.substr(from.find_last_of("/-.") + 1) : image.value("name", "");
}

/// By image: true if a material uses it as colours, which are sRGB (5.19 and the extensions of materials).
std::vector<bool> used_as_colors(const Scene& scene) {
  std::vector<bool> out(scene.images.size());
  for (const Material& m : scene.materials)
    for (const std::optional<TextureUse>* use :
         {&m.base_color_texture, &m.emissive_texture, &m.specular.color_texture, &m.sheen.color_texture})
      if (*use) out.at(scene.textures.at((*use)->texture.value).image.value) = true;
  return out;
}

Image decode(const GltfDocument& document, const ImportBudget& budget, std::size_t index,
             std::span<const unsigned char> encoded, bool color) {
  try {
    return decode_image(encoded, budget.memory(), {name_of(document.json["images"][index]), color});
  } catch (const Interrupted&) {
    throw;
  } catch (const std::runtime_error& e) {
    document.fail(json_path("/images", index), std::string("the image is ") + e.what());
  } catch (const std::length_error& e) {
    document.fail(json_path("/images", index), std::string("the image ") + e.what());
  }
}

Image read_image(const GltfDocument& document, const GltfResources& resources, const tinygltf::Model& model,
                 const ImportBudget& budget, std::size_t index, bool color) {
  const Json& image = document.json["images"][index];
  if (!image.contains("bufferView")) return decode(document, budget, index, resources.image(index), color);
  const tinygltf::BufferView& view = model.bufferViews[image["bufferView"].get<std::size_t>()];
  const std::span<const unsigned char> buffer = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
    document.fail(json_path(json_path("/images", index), "bufferView"), "lies beyond its buffer");
  return decode(document, budget, index, buffer.subspan(view.byteOffset, view.byteLength), color);
}

}  // namespace

void read_images(const GltfDocument& document, const GltfResources& resources, const GltfModel& model,
                 const ImportBudget& budget, const std::vector<std::size_t>& file_images, const ImageChoice& choice,
                 Executor* executor, Scene& scene) {
  scene.images.resize(file_images.size());
  for (std::size_t i = 0; i < file_images.size(); ++i) {
    const Json& image = document.json["images"][file_images[i]];
    scene.images[i].name =
        image.value("name", image.contains("bufferView") ? "" : image.value("uri", "").substr(0, 64));
  }
  const std::vector<bool> wanted = choice ? choice(scene) : std::vector<bool>(file_images.size(), true);
  const std::vector<bool> colors = used_as_colors(scene);
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < file_images.size(); ++i)
    if (wanted.at(i)) left.push_back(i);
  const auto read = [&](std::size_t i) {
    Image image = read_image(document, resources, model.model, budget, file_images[i], colors[i]);
    image.name = std::move(scene.images[i].name);
    scene.images[i] = std::move(image);
  };
  read_at_once(executor, std::move(left), read);
}

}  // namespace carousel::scene

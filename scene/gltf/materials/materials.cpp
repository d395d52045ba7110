// Khronos glTF 2.0 specification, 5.19 (material) and 5.22 (metallic-roughness).
#include "scene/gltf/materials/materials.h"

#include <algorithm>

#include "scene/gltf/document/numbers.h"
#include "scene/gltf/materials/material_layers.h"
#include "scene/gltf/materials/textures.h"

namespace carousel::scene {

namespace {

Material read_material(const Json& from, const std::string& path, TextureReader& textures) {
  static const Json nothing = Json::object();
  const auto child = [](const Json& object, const char* key) -> const Json& {
    const auto entry = object.find(key);
    return entry == object.end() ? nothing : *entry;
  };
  const Json& pbr = child(from, "pbrMetallicRoughness");
  const std::string pbr_path = json_path(path, "pbrMetallicRoughness");
  const Json& extensions = child(from, "extensions");

  Material to;
  to.name = from.value("name", "");
  to.base_color = glm::clamp(vector_in(pbr, "baseColorFactor", to.base_color), 0.0f, 1.0f);
  to.base_color_texture = textures.use(pbr, "baseColorTexture", pbr_path);
  to.metallic = unit_in(pbr, "metallicFactor", to.metallic);
  to.roughness = unit_in(pbr, "roughnessFactor", to.roughness);
  to.metallic_roughness_texture = textures.use(pbr, "metallicRoughnessTexture", pbr_path);
  const float strength = number_in(child(extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
  to.emissive = glm::clamp(vector_in(from, "emissiveFactor", to.emissive), 0.0f, 1.0f) * strength;
  to.emissive = glm::min(to.emissive, Vec3(3e38f));
  if (to.emissive != Vec3(0)) to.emissive_texture = textures.use(from, "emissiveTexture", path);
  to.normal_texture = textures.use(from, "normalTexture", path);
  to.normal_scale = number_in(child(from, "normalTexture"), "scale", 1);
  const std::string alpha = from.value("alphaMode", "OPAQUE");
  if (alpha == "MASK") to.alpha_mode = AlphaMode::kMask;
  if (alpha == "BLEND") to.alpha_mode = AlphaMode::kBlend;
  to.alpha_cutoff = number_in(from, "alphaCutoff", to.alpha_cutoff);
  to.double_sided = from.value("doubleSided", false);
  to.unlit = extensions.contains("KHR_materials_unlit");
  read_material_layers(extensions, json_path(path, "extensions"), textures, to);
  return to;
}

}  // namespace

std::vector<std::size_t> read_materials(const GltfDocument& document, Scene& scene, const WarningSink& warn) {
  TextureReader textures(document, scene);
  if (document.json.contains("materials")) {
    const Json& materials = document.json["materials"];
    for (std::size_t i = 0; i < materials.size(); ++i) {
      scene.materials.push_back(read_material(materials[i], json_path("/materials", i), textures));
    }
  }
  Material fallback;
  fallback.name = "default";
  scene.materials.push_back(fallback);
  textures.warn_of_dropped_uses(warn);
  return textures.images();
}

}  // namespace carousel::scene

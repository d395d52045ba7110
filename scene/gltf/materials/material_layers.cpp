// The Khronos extensions KHR_materials_*, each as its README and schema say: names, defaults, ranges.
#include "scene/gltf/materials/material_layers.h"

#include "scene/gltf/document/numbers.h"

namespace carousel::scene {

namespace {

/// An extension object and where it stands.
struct Layer {
  const Json& json;
  std::string path;
  TextureReader& textures;

  float unit(const char* key, float fallback) const { return unit_in(json, key, fallback); }
  std::optional<TextureUse> texture(const char* slot) const { return textures.use(json, slot, path); }
};

Vec3 unit_color(const Json& object, const char* key, const Vec3& fallback) {
  return glm::clamp(vector_in(object, key, fallback), 0.0f, 1.0f);
}

/// A wall nothing passes has an attenuation, but dividing by zero would be no distance.
constexpr float kLeastAttenuationDistance = 1e-6f;

Material::Transmission transmission(const Layer& from) {
  Material::Transmission to;
  to.weight = from.unit("transmissionFactor", to.weight);
  if (to.weight > 0) to.texture = from.texture("transmissionTexture");
  return to;
}

Material::Volume volume(const Layer& from) {
  Material::Volume to;
  to.thickness = at_least(0, from.json, "thicknessFactor", to.thickness);
  if (to.thickness > 0) to.thickness_texture = from.texture("thicknessTexture");
  to.attenuation_color = unit_color(from.json, "attenuationColor", to.attenuation_color);
  to.attenuation_distance =
      at_least(kLeastAttenuationDistance, from.json, "attenuationDistance", to.attenuation_distance);
  return to;
}

Material::Specular specular(const Layer& from) {
  Material::Specular to;
  to.weight = from.unit("specularFactor", to.weight);
  to.texture = from.texture("specularTexture");
  to.color = glm::max(vector_in(from.json, "specularColorFactor", to.color), 0.0f);  // may exceed 1
  to.color_texture = from.texture("specularColorTexture");
  return to;
}

Material::Clearcoat clearcoat(const Layer& from) {
  Material::Clearcoat to;
  to.weight = from.unit("clearcoatFactor", to.weight);
  if (to.weight == 0) return to;
  to.roughness = from.unit("clearcoatRoughnessFactor", to.roughness);
  to.texture = from.texture("clearcoatTexture");
  to.roughness_texture = from.texture("clearcoatRoughnessTexture");
  to.normal_texture = from.texture("clearcoatNormalTexture");
  if (to.normal_texture) to.normal_scale = number_in(from.json["clearcoatNormalTexture"], "scale", to.normal_scale);
  return to;
}

Material::Sheen sheen(const Layer& from) {
  Material::Sheen to;
  to.color = unit_color(from.json, "sheenColorFactor", to.color);
  if (to.color == Vec3(0)) return to;
  to.roughness = from.unit("sheenRoughnessFactor", to.roughness);
  to.color_texture = from.texture("sheenColorTexture");
  to.roughness_texture = from.texture("sheenRoughnessTexture");
  return to;
}

Material::Iridescence iridescence(const Layer& from) {
  Material::Iridescence to;
  to.weight = from.unit("iridescenceFactor", to.weight);
  if (to.weight == 0) return to;
  to.ior = at_least(1, from.json, "iridescenceIor", to.ior);
  to.thickness_min = at_least(0, from.json, "iridescenceThicknessMinimum", to.thickness_min);
  to.thickness_max = at_least(0, from.json, "iridescenceThicknessMaximum", to.thickness_max);
  to.texture = from.texture("iridescenceTexture");
  to.thickness_texture = from.texture("iridescenceThicknessTexture");
  return to;
}

Material::Anisotropy anisotropy(const Layer& from) {
  Material::Anisotropy to;
  to.strength = from.unit("anisotropyStrength", to.strength);
  if (to.strength == 0) return to;
  to.rotation = number_in(from.json, "anisotropyRotation", to.rotation);
  to.texture = from.texture("anisotropyTexture");
  return to;
}

float ior(const Json& from) {
  const float ior = number_in(from, "ior", 1.5f);
  return ior == 0 ? 0 : std::max(ior, 1.0f);  // 0 stands for infinite
}

}  // namespace

void read_material_layers(const Json& extensions, const std::string& path, TextureReader& textures, Material& to) {
  const auto read = [&](const char* name, auto& layer, const auto& reader) {
    const auto entry = extensions.find(name);
    if (entry != extensions.end()) layer = reader(Layer{*entry, json_path(path, name), textures});
  };
  if (const auto entry = extensions.find("KHR_materials_ior"); entry != extensions.end()) to.ior = ior(*entry);
  read("KHR_materials_transmission", to.transmission, transmission);
  read("KHR_materials_volume", to.volume, volume);
  read("KHR_materials_specular", to.specular, specular);
  read("KHR_materials_clearcoat", to.clearcoat, clearcoat);
  read("KHR_materials_sheen", to.sheen, sheen);
  read("KHR_materials_iridescence", to.iridescence, iridescence);
  read("KHR_materials_anisotropy", to.anisotropy, anisotropy);
}

}  // namespace carousel::scene

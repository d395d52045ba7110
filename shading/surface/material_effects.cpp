#include "shading/surface/material_effects.h"

#include <cmath>
#include <optional>

#include "shading/surface/surface.h"

namespace carousel::shading {

namespace {

using scene::AlphaMode;
using scene::Material;

constexpr float kMirrorRoughness = 0.0316f;  // squared this is the least alpha of the GGX lobe
constexpr float kStraight = 0.005f;          // an index this near to 1 does not refract

bool bright(const Vec3& color) {
  return color.x > 0 || color.y > 0 || color.z > 0;
}

/// Its texture can make a dielectric of what glTF takes for metal by default.
bool may_be_dielectric(const Material& m) {
  return m.metallic < 1 || m.metallic_roughness_texture;
}

}  // namespace

bool requires_effect(const Material& m, Effect effect) {
  switch (effect) {
    case Effect::kBaseColorTexture:
      return m.base_color_texture.has_value();
    case Effect::kUnlit:
      return m.unlit;
    case Effect::kAlphaMask:
      return m.alpha_mode == AlphaMode::kMask;
    case Effect::kAlphaBlend:
      return m.alpha_mode == AlphaMode::kBlend;
    default:
      break;
  }
  if (m.unlit) return false;
  const auto& s = m.specular;
  switch (effect) {
    case Effect::kMetallicRoughnessTexture:
      return m.metallic_roughness_texture.has_value();
    case Effect::kNormalMap:
      return m.normal_texture.has_value() || (m.clearcoat.weight > 0 && m.clearcoat.normal_texture);
    case Effect::kReflection:
      return m.metallic > 0 || s.weight > 0;
    case Effect::kMirror:
      return (m.metallic > 0 || s.weight > 0) && m.roughness <= kMirrorRoughness;
    case Effect::kEmission:
      return is_emissive(m);
    case Effect::kTransmission:
      return transmits(m);
    case Effect::kRefraction:
      return refracts(m);
    case Effect::kVolume:
      return absorbs(m);
    case Effect::kIor:
      return m.ior != 1.5f && may_be_dielectric(m);
    case Effect::kSpecular:
      return (s.weight != 1 || s.color != Vec3{1} || s.texture || s.color_texture) && may_be_dielectric(m);
    case Effect::kClearcoat:
      return m.clearcoat.weight > 0;
    case Effect::kSheen:
      return bright(m.sheen.color);
    case Effect::kIridescence:
      return m.iridescence.weight > 0;
    case Effect::kAnisotropy:
      return m.anisotropy.strength > 0;
    case Effect::kDoubleSided:
      return m.double_sided && is_emissive(m);  // back sides are drawn anyway, but glow only if told
    default:
      return false;
  }
}

void disable(Effect effect, Material& m) {
  switch (effect) {
    case Effect::kBaseColorTexture:
      m.base_color_texture.reset();
      break;
    case Effect::kMetallicRoughnessTexture:
      m.metallic_roughness_texture.reset();
      break;
    case Effect::kNormalMap:
      m.normal_texture.reset();
      m.clearcoat.normal_texture.reset();
      break;
    case Effect::kReflection:
      m.metallic = 0;
      m.specular = {.weight = 0, .color = Vec3{1}, .texture = {}, .color_texture = {}};
      break;
    case Effect::kMirror:
      if (m.roughness <= kMirrorRoughness) m.roughness = 0.3f;
      break;
    case Effect::kEmission:
      m.emissive = Vec3{0};
      m.emissive_texture.reset();
      break;
    case Effect::kTransmission:
      m.transmission = {};
      break;
    case Effect::kRefraction:
      m.volume.thickness = 0;
      break;
    case Effect::kVolume:
      m.volume.attenuation_distance = INFINITY;
      break;
    case Effect::kIor:
      m.ior = 1.5f;
      break;
    case Effect::kSpecular:
      m.specular = {};
      break;
    case Effect::kClearcoat:
      m.clearcoat = {};
      break;
    case Effect::kSheen:
      m.sheen = {};
      break;
    case Effect::kIridescence:
      m.iridescence = {};
      break;
    case Effect::kAnisotropy:
      m.anisotropy = {};
      break;
    case Effect::kAlphaMask:
      if (m.alpha_mode == AlphaMode::kMask) m.alpha_mode = AlphaMode::kOpaque;
      break;
    case Effect::kAlphaBlend:
      if (m.alpha_mode == AlphaMode::kBlend) m.alpha_mode = AlphaMode::kOpaque;
      break;
    case Effect::kDoubleSided:
      m.double_sided = false;
      break;
    case Effect::kUnlit:
      m.unlit = false;
      break;
    default:
      break;
  }
}

bool has_layers(const Material& m) {
  return m.clearcoat.weight > 0 || bright(m.sheen.color);
}

bool has_interface(const Material& m) {
  const auto& s = m.specular;
  return m.ior != 1.5f || s.weight != 1 || s.color != Vec3{1} || s.texture || s.color_texture ||
         m.transmission.weight > 0 || m.iridescence.weight > 0 || m.anisotropy.strength > 0;
}

bool transmits(const Material& m) {
  return m.transmission.weight > 0 && may_be_dielectric(m);
}

bool has_volume(const Material& m) {
  return transmits(m) && m.volume.thickness > 0;
}

bool refracts(const Material& m) {
  return has_volume(m) && m.ior >= 1 && std::abs(m.ior - 1) > kStraight;
}

bool absorbs(const Material& m) {
  const auto& v = m.volume;
  return has_volume(m) && std::isfinite(v.attenuation_distance) && v.attenuation_distance > 0 &&
         v.attenuation_color != Vec3{1};
}

std::vector<scene::TextureUse> textures_read(const Material& m) {
  std::vector<scene::TextureUse> read;
  const auto one = [&](const std::optional<scene::TextureUse>& use) {
    if (use) read.push_back(*use);
  };
  one(m.base_color_texture);
  if (m.unlit) return read;
  one(m.metallic_roughness_texture);
  one(m.emissive_texture);
  one(m.normal_texture);
  if (m.transmission.weight > 0) one(m.transmission.texture);
  one(m.specular.texture);
  one(m.specular.color_texture);
  if (m.clearcoat.weight > 0) {
    one(m.clearcoat.texture);
    one(m.clearcoat.roughness_texture);
    one(m.clearcoat.normal_texture);
  }
  if (bright(m.sheen.color)) {
    one(m.sheen.color_texture);
    one(m.sheen.roughness_texture);
  }
  if (m.iridescence.weight > 0) {
    one(m.iridescence.texture);
    one(m.iridescence.thickness_texture);
  }
  if (m.anisotropy.strength > 0) one(m.anisotropy.texture);
  return read;
}

std::vector<bool> reached_materials(const scene::Scene& scene) {
  std::vector<bool> reached(scene.materials.size(), false), seen(scene.meshes.size(), false);
  for (const scene::Instance& instance : scene.instances) {
    if (seen[instance.mesh.value]) continue;
    seen[instance.mesh.value] = true;
    for (const MaterialId id : scene.meshes[instance.mesh.value].triangle_materials) reached[id.value] = true;
    for (const scene::Sphere& sphere : scene.meshes[instance.mesh.value].spheres) reached[sphere.material.value] = true;
  }
  return reached;
}

}  // namespace carousel::shading

#include "scene/gltf_materials.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace carousel::scene {

namespace {

float unit_range(double v) {
  return static_cast<float>(std::clamp(v, 0.0, 1.0));
}

Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::kClamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::kMirror : Wrap::kRepeat;
}

/// The member `key` of an extension object as numbers; `fallback` where it is absent.
float number_in(const tinygltf::Value& object, const char* key, float fallback) {
  return object.Has(key) ? static_cast<float>(object.Get(key).GetNumberAsDouble()) : fallback;
}
Vec2 pair_in(const tinygltf::Value& object, const char* key, Vec2 fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& pair = object.Get(key);
  return {static_cast<float>(pair.Get(0).GetNumberAsDouble()),
          static_cast<float>(pair.Get(1).GetNumberAsDouble())};
}

class MaterialReader {
 public:
  MaterialReader(const GltfDocument& document, GltfModel& model, Scene& scene, const WarningSink& warn)
      : document_(document), model_(model), scene_(scene), warn_(warn) {}

  Material material(const tinygltf::Material& from) {
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    Material to;
    to.name = from.name;
    for (int c = 0; c < 4; ++c)
      to.base_color[c] = unit_range(pbr.baseColorFactor[static_cast<std::size_t>(c)]);
    to.base_color_texture = use(pbr.baseColorTexture);
    to.metallic = unit_range(pbr.metallicFactor);
    to.roughness = unit_range(pbr.roughnessFactor);
    to.metallic_roughness_texture = use(pbr.metallicRoughnessTexture);
    const float strength = emissive_strength(from);
    for (int c = 0; c < 3; ++c) {
      to.emissive[c] =
          std::min(unit_range(from.emissiveFactor[static_cast<std::size_t>(c)]) * strength, 3e38f);
    }
    to.emissive_texture = use(from.emissiveTexture);
    to.normal_texture = use(from.normalTexture);
    to.normal_scale = static_cast<float>(from.normalTexture.scale);
    if (from.alphaMode == "MASK") to.alpha_mode = AlphaMode::kMask;
    if (from.alphaMode == "BLEND") to.alpha_mode = AlphaMode::kBlend;
    to.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    to.double_sided = from.doubleSided;
    to.unlit = from.extensions.contains("KHR_materials_unlit");
    return to;
  }

  void warn_of_dropped_uses() const {
    if (!warn_ || dropped_.empty()) return;
    std::string text;
    for (const auto& [reason, count] : dropped_)
      text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + reason;
    warn_(document_.file + ": texture uses ignored: " + text);
  }

 private:
  static float emissive_strength(const tinygltf::Material& from) {
    const auto entry = from.extensions.find("KHR_materials_emissive_strength");
    return entry == from.extensions.end() ? 1.0f : number_in(entry->second, "emissiveStrength", 1.0f);
  }

  template <class Info>
  std::optional<TextureUse> use(const Info& info) {
    if (info.index < 0) return std::nullopt;
    TextureUse out;
    int uv_set = info.texCoord;
    if (const auto entry = info.extensions.find("KHR_texture_transform"); entry != info.extensions.end()) {
      const tinygltf::Value& transform = entry->second;
      out.offset = pair_in(transform, "offset", out.offset);
      out.scale = pair_in(transform, "scale", out.scale);
      out.rotation = number_in(transform, "rotation", 0);
      if (transform.Has("texCoord")) uv_set = transform.Get("texCoord").GetNumberAsInt();
    }
    if (uv_set > 1) {
      ++dropped_["with a texture coordinate set beyond 1"];
      return std::nullopt;
    }
    if (model_.model.textures[static_cast<std::size_t>(info.index)].source < 0) {
      ++dropped_["without a PNG or JPEG source"];
      return std::nullopt;
    }
    out.uv_set = static_cast<std::uint8_t>(uv_set);
    out.texture = texture(info.index);
    return out;
  }

  TextureId texture(int index) {
    const auto [entry, fresh] =
        textures_.try_emplace(index, static_cast<std::uint32_t>(scene_.textures.size()));
    if (fresh) {
      const tinygltf::Texture& from = model_.model.textures[static_cast<std::size_t>(index)];
      Texture to;
      to.image = image(from.source);
      if (from.sampler >= 0) {
        const tinygltf::Sampler& sampler = model_.model.samplers[static_cast<std::size_t>(from.sampler)];
        to.wrap_u = wrap_of(sampler.wrapS);
        to.wrap_v = wrap_of(sampler.wrapT);
        to.linear_filter = sampler.magFilter != TINYGLTF_TEXTURE_FILTER_NEAREST;
      }
      scene_.textures.push_back(to);
    }
    return TextureId(entry->second);
  }

  ImageId image(int index) {
    const auto [entry, fresh] = images_.try_emplace(index, static_cast<std::uint32_t>(scene_.images.size()));
    if (fresh) scene_.images.push_back(std::move(model_.images[static_cast<std::size_t>(index)]));
    return ImageId(entry->second);
  }

  const GltfDocument& document_;
  GltfModel& model_;
  Scene& scene_;
  const WarningSink& warn_;
  std::map<int, std::uint32_t> textures_, images_;
  std::map<std::string, int> dropped_;
};

}  // namespace

void read_materials(const GltfDocument& document, GltfModel& model, Scene& scene, const WarningSink& warn) {
  MaterialReader reader(document, model, scene, warn);
  for (const tinygltf::Material& material : model.model.materials)
    scene.materials.push_back(reader.material(material));
  Material fallback;
  fallback.name = "default";
  scene.materials.push_back(fallback);
  reader.warn_of_dropped_uses();
}

}  // namespace carousel::scene

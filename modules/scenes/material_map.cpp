#include "modules/scenes/material_map.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <assimp/GltfMaterial.h>

namespace carousel::scenes {

namespace {

using scene::AlphaMode;
using scene::Imported;
using scene::Material;
using scene::TextureUse;
using scene::Wrap;

std::optional<float> number(const aiMaterial& m, const char* key, unsigned type, unsigned index) {
  float value = 0;
  if (m.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return value;
}

std::optional<Vec3> color(const aiMaterial& m, const char* key, unsigned type, unsigned index) {
  aiColor4D value;
  if (m.Get(key, type, index, value) != aiReturn_SUCCESS) return std::nullopt;
  return Vec3(value.r, value.g, value.b);
}

std::string path_of(const aiMaterial& m, aiTextureType type) {
  aiString path;
  return m.GetTexture(type, 0, &path) == aiReturn_SUCCESS ? std::string(path.C_Str()) : std::string();
}

Wrap wrap_of(int mode) {
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? Wrap::kClamp
         : mode == aiTextureMapMode_Mirror                                ? Wrap::kMirror
                                                                          : Wrap::kRepeat;
}

/// glTF's roughness of a Blinn-Phong exponent: its square is alpha, and the exponent 2 / alpha^2 - 2. B. Karis,
/// "Specular BRDF reference", 2013.
float roughness_of(float exponent) {
  return std::sqrt(std::sqrt(2 / (std::max(exponent, 0.0f) + 2)));
}

}  // namespace

void MaterialMap::map_all() {
  for (unsigned i = 0; i < from_.mNumMaterials; ++i) to_.materials.push_back(map(*from_.mMaterials[i]));
  std::string parts;
  for (const std::string& part : unlike_) parts += (parts.empty() ? "" : ", ") + part;
  if (!parts.empty()) to_.warnings.push_back("parts of materials without a counterpart are ignored: " + parts);
}

Material MaterialMap::map(const aiMaterial& from) {
  Material to;
  to.name = from.GetName().C_Str();
  map_colors(from, to);
  map_textures(from, to);
  return to;
}

void MaterialMap::map_colors(const aiMaterial& from, Material& to) {
  const auto base = color(from, AI_MATKEY_BASE_COLOR), diffuse = color(from, AI_MATKEY_COLOR_DIFFUSE);
  to.base_color = Vec4(base ? *base : diffuse.value_or(Vec3(1)), 1);
  const auto metallic = number(from, AI_MATKEY_METALLIC_FACTOR), roughness = number(from, AI_MATKEY_ROUGHNESS_FACTOR);
  const auto glossiness = number(from, AI_MATKEY_GLOSSINESS_FACTOR), shininess = number(from, AI_MATKEY_SHININESS);
  to.metallic = metallic.value_or(0);
  to.roughness = roughness ? *roughness : glossiness ? 1 - *glossiness : roughness_of(shininess.value_or(0));
  to.emissive =
      color(from, AI_MATKEY_COLOR_EMISSIVE).value_or(Vec3(0)) * number(from, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1);
  to.transmission.weight = number(from, AI_MATKEY_TRANSMISSION_FACTOR).value_or(0);
  // Many writers leave the index at 1, which would take the gloss from every surface.
  if (const float ior = number(from, AI_MATKEY_REFRACTI).value_or(1); ior > 1) to.ior = ior;
  if (const float opacity = number(from, AI_MATKEY_OPACITY).value_or(1); opacity < 1) {
    to.base_color.w = opacity;
    to.alpha_mode = AlphaMode::kBlend;
  }
  int two_sided = 1, model = 0;  // formats that do not say it show both sides
  static_cast<void>(from.Get(AI_MATKEY_TWOSIDED, two_sided));
  to.double_sided = two_sided != 0;
  if (from.Get(AI_MATKEY_SHADING_MODEL, model) == aiReturn_SUCCESS) to.unlit = model == aiShadingMode_NoShading;
  if (!metallic)
    if (const auto specular = color(from, AI_MATKEY_COLOR_SPECULAR); specular && *specular != Vec3(0))
      unlike("specular colours");
  if (const auto clear = color(from, AI_MATKEY_COLOR_TRANSPARENT); clear && *clear != Vec3(0) && *clear != Vec3(1))
    unlike("transparent colours");
  if (const auto coat = number(from, AI_MATKEY_CLEARCOAT_FACTOR); coat && *coat != 0) unlike("clear coats");
  if (const auto sheen = color(from, AI_MATKEY_SHEEN_COLOR_FACTOR); sheen && *sheen != Vec3(0)) unlike("sheen");
}

void MaterialMap::map_textures(const aiMaterial& from, Material& to) {
  to.base_color_texture = texture(from, aiTextureType_BASE_COLOR);
  if (!to.base_color_texture) to.base_color_texture = texture(from, aiTextureType_DIFFUSE);
  to.normal_texture = texture(from, aiTextureType_NORMALS);
  if (!to.normal_texture) to.normal_texture = texture(from, aiTextureType_NORMAL_CAMERA);
  to.emissive_texture = texture(from, aiTextureType_EMISSIVE);
  if (!to.emissive_texture) to.emissive_texture = texture(from, aiTextureType_EMISSION_COLOR);
  if (to.emissive_texture && to.emissive == Vec3(0)) to.emissive = Vec3(1);

  const std::string metal = path_of(from, aiTextureType_METALNESS),
                    rough = path_of(from, aiTextureType_DIFFUSE_ROUGHNESS);
  if (!metal.empty() && metal == rough) {
    to.metallic_roughness_texture = texture(from, aiTextureType_METALNESS);
    if (to.metallic == 0) to.metallic = 1;
  } else if (!metal.empty() || !rough.empty()) {
    unlike("textures of metal or roughness alone");
  }
  if (const std::string opacity = path_of(from, aiTextureType_OPACITY); !opacity.empty()) {
    const bool base =
        opacity == path_of(from, aiTextureType_DIFFUSE) || opacity == path_of(from, aiTextureType_BASE_COLOR);
    if (base)
      to.alpha_mode = AlphaMode::kBlend;
    else
      unlike("textures of opacity alone");
  }
  constexpr std::pair<aiTextureType, const char*> kUnlike[] = {{aiTextureType_HEIGHT, "textures of height (bump maps)"},
                                                               {aiTextureType_DISPLACEMENT, "displacement"},
                                                               {aiTextureType_SPECULAR, "textures of specular colour"},
                                                               {aiTextureType_SHININESS, "textures of shininess"},
                                                               {aiTextureType_REFLECTION, "reflection maps"}};
  for (const auto& [type, name] : kUnlike)
    if (from.GetTextureCount(type) > 0) unlike(name);
  if (from.GetTextureCount(aiTextureType_DIFFUSE) > 1 || from.GetTextureCount(aiTextureType_BASE_COLOR) > 1)
    unlike("layers of textures");
}

std::optional<std::uint32_t> MaterialMap::image_of(const std::string& name) {
  const auto [entry, fresh] = images_.try_emplace(name);
  if (!fresh) return entry->second;
  Imported::Image image;
  image.name = name.substr(0, 64);
  const std::string last = name.substr(name.find_last_of("/\\") + 1);
  if (const aiTexture* held = from_.GetEmbeddedTexture(name.c_str())) {
    image.place = "texture " + name;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(held->pcData);
    if (held->mHeight == 0) {
      image.bytes.assign(bytes, bytes + held->mWidth);
    } else {
      image.width = held->mWidth;
      image.height = held->mHeight;
      const std::size_t pixels = std::size_t{held->mWidth} * held->mHeight;
      image.bytes.reserve(4 * pixels);
      for (std::size_t i = 0; i < pixels; ++i) {
        const aiTexel& t = held->pcData[i];
        image.bytes.insert(image.bytes.end(), {t.r, t.g, t.b, t.a});
      }
    }
  } else {
    image.place = files_.place_of(last);
    image.file = files_.find(name).string();
    to_.files.push_back(image.file.empty() ? files_.beside(name) : image.file);
    if (image.file.empty()) {
      to_.warnings.push_back((image.place.empty() ? "" : image.place + ": ") + "the image '" + name +
                             "' is not there, in the folder of the model or the two above it; shown without it");
      return entry->second;
    }
  }
  entry->second = static_cast<std::uint32_t>(to_.images.size());
  to_.images.push_back(std::move(image));
  return entry->second;
}

std::optional<TextureUse> MaterialMap::texture(const aiMaterial& material, aiTextureType type) {
  const std::string path = path_of(material, type);
  if (path.empty()) return std::nullopt;
  const auto image = image_of(path);
  if (!image) return std::nullopt;
  int wrap_u = aiTextureMapMode_Wrap, wrap_v = aiTextureMapMode_Wrap, set = 0;
  static_cast<void>(material.Get(AI_MATKEY_MAPPINGMODE_U(type, 0), wrap_u));
  static_cast<void>(material.Get(AI_MATKEY_MAPPINGMODE_V(type, 0), wrap_v));
  static_cast<void>(material.Get(AI_MATKEY_UVWSRC(type, 0), set));
  if (set < 0 || set > 1) {
    unlike("textures on further sets of coordinates");
    return std::nullopt;
  }
  scene::Texture texture;
  texture.image = ImageId(*image);
  texture.wrap_u = wrap_of(wrap_u);
  texture.wrap_v = wrap_of(wrap_v);
  TextureUse use;
  use.texture = TextureId(static_cast<std::uint32_t>(to_.textures.size()));
  use.uv_set = static_cast<std::uint8_t>(set);
  to_.textures.push_back(texture);
  aiUVTransform moved;
  if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), moved) == aiReturn_SUCCESS) {
    if (moved.mRotation != 0) unlike("rotated textures");
    // Assimp's v grows upwards, and the program's downwards.
    use.scale = Vec2(moved.mScaling.x, moved.mScaling.y);
    use.offset = Vec2(moved.mTranslation.x, 1 - moved.mScaling.y - moved.mTranslation.y);
  }
  return use;
}

}  // namespace carousel::scenes

#include "scene/gltf/document/uses.h"

#include <string_view>

namespace carousel::scene {

namespace {

const Json& used_entries(const Json& json, const char* key) {
  static const Json none = Json::array();
  const auto entry = json.find(key);
  return entry == json.end() ? none : *entry;
}

void mark(std::vector<bool>& used, const Json& owner, const char* key) {
  if (const auto index = owner.find(key); index != owner.end()) used.at(index->get<std::size_t>()) = true;
}

void mark_all(std::vector<bool>& used, const Json& owner, const char* key) {
  for (const Json& index : used_entries(owner, key)) used.at(index.get<std::size_t>()) = true;
}

/// Marks the textures of a material, its layers included.
void mark_textures(std::vector<bool>& used, const Json& material) {
  for (const auto& [key, value] : material.items()) {
    if (!value.is_object() || key == "occlusionTexture") continue;
    if (std::string_view(key).ends_with("Texture"))
      mark(used, value, "index");
    else
      mark_textures(used, value);
  }
}

/// The number of the coordinate set that a use of a texture names.
int set_of(const Json& use) {
  const Json::json_pointer moved("/extensions/KHR_texture_transform/texCoord");
  return use.contains(moved) ? use.at(moved).get<int>() : use.value("texCoord", 0);
}

/// Marks what the pose reads: played animations, skins of nodes, differences of morph targets.
void mark_posed(Uses& out, const Json& json, const Posing& posing) {
  for (const Json& node : used_entries(json, "nodes")) mark(out.skins, node, "skin");
  for (std::size_t s = 0; s < out.skins.size(); ++s)
    if (out.skins[s]) mark(out.accessors, json["skins"][s], "inverseBindMatrices");
  out.animations = posing.animations;
  for (std::size_t a = 0; a < out.animations.size(); ++a) {
    if (!out.animations[a]) continue;
    for (const Json& sampler : json["animations"][a]["samplers"]) {
      mark(out.accessors, sampler, "input");
      mark(out.accessors, sampler, "output");
    }
  }
  for (const Json& mesh : used_entries(json, "meshes"))
    for (const Json& primitive : used_entries(mesh, "primitives"))
      for (const Json& target : used_entries(primitive, "targets"))
        for (const Json& accessor : target) out.accessors.at(accessor.get<std::size_t>()) = true;
}

}  // namespace

bool reads_tex_coords(const Json& material, int set) {
  for (const auto& [key, value] : material.items()) {
    if (!value.is_object() || key == "occlusionTexture") continue;
    const bool texture = std::string_view(key).ends_with("Texture");
    if (texture ? set_of(value) == set : reads_tex_coords(value, set)) return true;
  }
  return false;
}

Uses uses_of(const Json& json, const Posing& posing) {
  Uses out;
  const auto size = [&](const char* key) { return used_entries(json, key).size(); };
  out.textures.resize(size("textures"));
  out.images.resize(size("images"));
  out.samplers.resize(size("samplers"));
  out.cameras.resize(size("cameras"));
  out.accessors.resize(size("accessors"));
  out.skins.resize(size("skins"));
  out.animations.resize(size("animations"));
  if (posing.on) mark_posed(out, json, posing);
  for (const Json& material : used_entries(json, "materials")) mark_textures(out.textures, material);
  for (std::size_t t = 0; t < out.textures.size(); ++t) {
    if (!out.textures[t]) continue;
    const Json& texture = json["textures"][t];
    mark(out.images, texture, "source");
    mark(out.samplers, texture, "sampler");
    for (const Json& extension : used_entries(texture, "extensions")) mark(out.images, extension, "source");
  }
  for (const Json& node : used_entries(json, "nodes")) {
    mark(out.cameras, node, "camera");
    const Json::json_pointer instancing("/extensions/EXT_mesh_gpu_instancing");
    if (node.contains(instancing)) mark_all(out.accessors, node.at(instancing), "attributes");
  }
  for (const Json& mesh : used_entries(json, "meshes")) {
    for (const Json& primitive : used_entries(mesh, "primitives")) {
      mark_all(out.accessors, primitive, "attributes");
      mark(out.accessors, primitive, "indices");
    }
  }
  return out;
}

}  // namespace carousel::scene

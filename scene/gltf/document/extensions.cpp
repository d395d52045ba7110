#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "scene/gltf/document/checks.h"

namespace carousel::scene {

namespace {

constexpr auto kRead = std::to_array<std::string_view>({
    "EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",    "EXT_texture_webp",
    "KHR_draco_mesh_compression", "KHR_gaussian_splatting",     "KHR_lights_punctual",
    "KHR_materials_anisotropy",   "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_iridescence",  "KHR_materials_sheen",
    "KHR_materials_specular",     "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_volume",       "KHR_mesh_quantization",      "KHR_meshopt_compression",
    "KHR_node_visibility",        "KHR_texture_transform",
});

bool has_entries(const Json& json, const char* key) {
  const auto entry = json.find(key);
  return entry != json.end() && entry->is_array() && !entry->empty();
}

}  // namespace

std::size_t count_morph_targets(const Json& json) {
  std::size_t out = 0;
  const auto meshes = json.find("meshes");
  if (meshes == json.end() || !meshes->is_array()) return out;
  for (const Json& mesh : *meshes) {
    if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) continue;
    // All primitives of a mesh have the same targets (specification, 3.7.2.2).
    for (const Json& primitive : mesh["primitives"]) {
      if (!primitive.is_object() || !primitive.contains("targets")) continue;
      out += primitive["targets"].size();
      break;
    }
  }
  return out;
}

void check_extensions(const GltfDocument& document, const WarningSink& warn) {
  const Json& json = document.json;
  if (has_entries(json, "extensionsRequired")) {
    const Json& required = json["extensionsRequired"];
    for (std::size_t i = 0; i < required.size(); ++i) {
      if (!required[i].is_string()) continue;  // the schema check reports this with a better message
      const auto& name = required[i].get_ref<const std::string&>();
      if (std::ranges::find(kRead, name) == kRead.end()) {
        document.fail(json_path("/extensionsRequired", i),
                      "the file requires " + name + ", which Carousel does not read");
      }
    }
  }
  if (!warn) return;
  std::string ignored;
  if (has_entries(json, "extensionsUsed")) {
    for (const Json& entry : json["extensionsUsed"]) {
      if (!entry.is_string()) continue;
      const auto& name = entry.get_ref<const std::string&>();
      if (std::ranges::find(kRead, name) != kRead.end()) continue;
      ignored += (ignored.empty() ? "" : ", ") + name;
    }
  }
  if (!ignored.empty()) warn(document.file + ": optional extensions ignored: " + ignored);
  if (document.posing.on) return;
  std::string posed;
  for (const char* key : {"animations", "skins"}) {
    if (has_entries(json, key)) posed += (posed.empty() ? "" : ", ") + std::string(key);
  }
  if (document.morph_targets > 0) posed += (posed.empty() ? "" : ", ") + std::string("morph targets");
  if (!posed.empty()) warn(document.file + ": ignored, the base pose is shown: " + posed);
}

}  // namespace carousel::scene

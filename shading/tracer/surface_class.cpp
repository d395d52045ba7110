#include "shading/tracer/surface_class.h"

#include <algorithm>
#include <array>

#include "shading/surface/material_effects.h"

namespace carousel::shading {

using scene::Material;

std::string_view class_name(SurfaceClass surface) {
  constexpr std::array<std::string_view, kSurfaceClasses> kNames{
      "unlit",   "plain", "textured", "layered", "opaque", "layered_opaque", "transmissive", "layered_transmissive",
      "anything"};
  return kNames[static_cast<std::size_t>(surface)];
}

namespace {

SurfaceClass surface_class(const Material& m, bool colors) {
  if (m.unlit) return SurfaceClass::kUnlit;
  const bool layers = has_layers(m);
  if (transmits(m)) return layers ? SurfaceClass::kLayeredTransmissive : SurfaceClass::kTransmissive;
  if (has_interface(m)) return layers ? SurfaceClass::kLayeredOpaque : SurfaceClass::kOpaque;
  if (layers) return SurfaceClass::kLayered;
  const bool textures = m.base_color_texture || m.metallic_roughness_texture || m.normal_texture || colors;
  return textures ? SurfaceClass::kTextured : SurfaceClass::kPlain;
}

}  // namespace

std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan) {
  std::vector<bool> colors(scene.materials.size(), false);
  for (const scene::Mesh& mesh : scene.meshes) {
    if (mesh.colors.empty()) continue;
    for (const MaterialId id : mesh.triangle_materials) colors[id.value] = true;
  }
  std::vector<SurfaceClass> classes;
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    classes.push_back(plan.everything ? SurfaceClass::kAnything : surface_class(scene.materials[i], colors[i]));
  return classes;
}

std::vector<std::pair<SurfaceClass, std::uint32_t>> count_classes(const scene::Scene& scene, const EffectsPlan& plan) {
  const std::vector<bool> reached = reached_materials(scene);
  const std::vector<SurfaceClass> classes = surface_classes(scene, plan);
  std::array<std::uint32_t, kSurfaceClasses> counts{};
  for (std::size_t i = 0; i < classes.size(); ++i) counts[static_cast<std::size_t>(classes[i])] += reached[i] ? 1u : 0u;
  std::vector<std::pair<SurfaceClass, std::uint32_t>> out;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) out.emplace_back(static_cast<SurfaceClass>(i), counts[i]);
  return out;
}

std::vector<std::uint32_t> extra_effects(const scene::Scene& scene, const EffectsPlan& plan) {
  std::vector<std::uint32_t> counts;
  for (const Material& material : scene.materials) {
    const auto has = [&](Effect effect) { return plan.everything || requires_effect(material, effect); };
    counts.push_back(static_cast<std::uint32_t>(std::count_if(kExtraEffects.begin(), kExtraEffects.end(), has)));
  }
  return counts;
}

}  // namespace carousel::shading

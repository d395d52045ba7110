#include "shading/tracer/surface_class.h"

#include <array>

#include "core/types/shader_kind.h"
#include "shading/surface/material_properties.h"

namespace carousel::shading {

using scene::Material;

std::string_view class_name(SurfaceClass surface) {
  static_assert(kFirstSurfaceKind + kSurfaceClasses == kCameraKind);
  return kShaderKindNames[kFirstSurfaceKind + static_cast<std::size_t>(surface)];
}

namespace {

SurfaceClass surface_class(const Material& material, ShaderParts parts) {
  if (material.unlit) return SurfaceClass::kUnlit;
  const bool layers = parts & kLayers;
  if (parts & kTransmission) return layers ? SurfaceClass::kLayeredTransmissive : SurfaceClass::kTransmissive;
  if (parts & kBoundary) return layers ? SurfaceClass::kLayeredOpaque : SurfaceClass::kOpaque;
  if (layers) return SurfaceClass::kLayered;
  return parts & kTextures ? SurfaceClass::kTextured : SurfaceClass::kPlain;
}

}  // namespace

std::vector<ShaderParts> parts_of_materials(const scene::Scene& scene) {
  std::vector<ShaderParts> parts;
  for (const Material& material : scene.materials) parts.push_back(shader_parts(material));
  for (const EffectRule& rule : effect_rules()) {
    if (rule.mesh == nullptr) continue;
    for (const scene::Mesh& mesh : scene.meshes) {
      if (!rule.mesh(mesh)) continue;
      for (const MaterialId id : mesh.triangle_materials) parts[id.value] = parts[id.value] | rule.shader;
    }
  }
  return parts;
}

std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan) {
  const std::vector<ShaderParts> parts = parts_of_materials(scene);
  std::vector<SurfaceClass> classes;
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    classes.push_back(plan.everything ? SurfaceClass::kAnything : surface_class(scene.materials[i], parts[i]));
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

namespace {

/// True if every lit surface pays for an effect of the whole scene, a light that shadow rays look for.
bool is_at_surfaces(const EffectsPlan& plan, Effect effect) {
  return plan.on(effect) && plan.of(effect).called_for && plan.on(Effect::kShadowRays);
}

}  // namespace

ShadeWork extra_work_of_misses(const EffectsPlan& plan) {
  ShadeWork work;
  for (const EffectRule& rule : effect_rules()) {
    if (rule.miss_products == 0) continue;
    if (plan.on(rule.effect) && plan.of(rule.effect).called_for) {
      work.products += rule.miss_products;
      work.lookups += rule.texture_reads;
    } else if (plan.everything) {
      work.products += kCheckProducts;
    }
  }
  return work;
}

std::vector<ShadeWork> extra_work(const scene::Scene& scene, const EffectsPlan& plan) {
  std::vector<ShadeWork> work;
  for (const Material& material : scene.materials) {
    ShadeWork& own = work.emplace_back();
    for (const EffectRule& rule : effect_rules()) {
      if (rule.products == 0) continue;
      const bool lit_by = rule.scene != nullptr && !material.unlit && is_at_surfaces(plan, rule.effect);
      if (lit_by) own.lookups += rule.texture_reads;
      if (lit_by || requires_effect(rule, material)) {
        own.products += rule.products;
      } else if (plan.everything) {
        own.products += rule.evaluated_without && !material.unlit ? rule.products : kCheckProducts;
      }
    }
    own.lookups += static_cast<std::uint32_t>(textures_read(material).size());
  }
  for (const EffectRule& rule : effect_rules()) {
    if (rule.mesh == nullptr || rule.products == 0) continue;
    std::vector<bool> called(work.size());
    for (const scene::Mesh& mesh : scene.meshes)
      if (rule.mesh(mesh))
        for (const MaterialId id : mesh.triangle_materials) called[id.value] = true;
    for (std::size_t i = 0; i < work.size(); ++i)
      if (called[i]) work[i].products += rule.products - (plan.everything ? kCheckProducts : 0);
  }
  return work;
}

}  // namespace carousel::shading

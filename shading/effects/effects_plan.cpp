#include "shading/effects/effects_plan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "shading/math/luminance.h"
#include "shading/path/path_pool.h"
#include "shading/surface/material_effects.h"
#include "shading/surface/surface.h"

namespace carousel::shading {

namespace {

using scene::Material;

bool is_of_materials(Effect effect) {
  return effect <= Effect::kUnlit && effect != Effect::kVertexColor;
}

using Kind = scene::PunctualLight::Kind;

std::optional<Kind> light_kind(Effect effect) {
  if (effect == Effect::kPointLights) return Kind::kPoint;
  if (effect == Effect::kSpotLights) return Kind::kSpot;
  if (effect == Effect::kDirectionalLights) return Kind::kDirectional;
  return std::nullopt;
}

std::uint32_t texture_reads(Effect effect) {
  switch (effect) {
    case Effect::kBaseColorTexture:
    case Effect::kMetallicRoughnessTexture:
    case Effect::kNormalMap:
    case Effect::kEmission:
    case Effect::kTransmission:
    case Effect::kAnisotropy:
    case Effect::kAlphaMask:
    case Effect::kAlphaBlend:
      return 1;
    case Effect::kSpecular:
    case Effect::kClearcoat:
    case Effect::kSheen:
    case Effect::kIridescence:
      return 2;
    default:
      return 0;
  }
}

class Planner {
 public:
  Planner(const scene::Scene& scene, const Config& config)
      : scene_(scene), config_(config), reached_(reached_materials(scene)) {}

  EffectsPlan plan() {
    for (std::size_t i = 0; i < kEffects; ++i) look_for(static_cast<Effect>(i));
    secondary_rays();
    const ShadingConfig::Effects& choice = config_.shading.effects;
    plan_.everything = choice.choice == ShadingConfig::Effects::Choice::kAll;
    for (std::size_t i = 0; i < kEffects; ++i) {
      PlannedEffect& e = plan_.effects[i];
      const auto named = std::find(choice.names.begin(), choice.names.end(), kEffectNames[i]) != choice.names.end();
      const bool left_out = choice.choice == ShadingConfig::Effects::Choice::kList && !named;
      e.on = plan_.everything || (e.called_for && !left_out);
      if (left_out && e.called_for) e.why += "; left out by shading.effects";
    }
    for (std::size_t i = 0; i < kEffects; ++i)
      if (plan_.effects[i].on) costs(static_cast<Effect>(i), plan_.effects[i].cost);
    return plan_;
  }

 private:
  PlannedEffect& at(Effect effect) { return plan_.effects[static_cast<std::size_t>(effect)]; }

  void look_for(Effect effect) {
    PlannedEffect& e = at(effect);
    if (is_of_materials(effect)) {
      call_materials(e, [&](const Material& m) { return requires_effect(m, effect); });
    } else if (effect == Effect::kVertexColor) {
      for (const scene::Mesh& mesh : scene_.meshes) call(e, !mesh.colors.empty(), "mesh", mesh.name);
    } else if (effect == Effect::kAreaLights) {
      call_materials(e, is_emissive);
    } else if (const auto kind = light_kind(effect)) {
      for (std::size_t i = 0; i < scene_.lights.size(); ++i)
        call(e, scene_.lights[i].kind == *kind && max_component(scene_.lights[i].intensity) > 0, "light",
             std::to_string(i));
    } else if (effect == Effect::kSky) {
      call(e, max_component(scene_.sky.radiance) > 0, "sky", "");
    } else if (effect == Effect::kDepthOfField) {
      call(e, config_.camera.aperture > 0, "camera.aperture", "");
    }
    conclude(e);
  }

  template <class Predicate>
  void call_materials(PlannedEffect& e, const Predicate& calls) {
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
      const std::string& name = scene_.materials[i].name;
      call(e, reached_[i] && calls(scene_.materials[i]), "material", name.empty() ? std::to_string(i) : name);
    }
  }

  static void call(PlannedEffect& e, bool calls, const char* what, const std::string& name) {
    if (!calls) return;
    if (++e.callers == 1) e.why = fmt::format("{}{}{}", what, name.empty() ? "" : " ", name);
  }
  static void conclude(PlannedEffect& e) {
    e.called_for = e.callers > 0;
    if (e.callers > 1) e.why += fmt::format(" and {} more", e.callers - 1);
    if (!e.called_for) e.why = "nothing calls for it";
  }

  /// What they need is the other effects' presence.
  void secondary_rays() {
    const auto any = [&](std::initializer_list<Effect> list) {
      return std::any_of(list.begin(), list.end(), [&](Effect effect) { return at(effect).called_for; });
    };
    bool lit = false;
    for (std::size_t i = 0; i < scene_.materials.size(); ++i) lit = lit || (reached_[i] && !scene_.materials[i].unlit);
    const bool lights =
        any({Effect::kPointLights, Effect::kSpotLights, Effect::kDirectionalLights, Effect::kAreaLights});
    PlannedEffect& shadow = at(Effect::kShadowRays);
    shadow.called_for = lit && lights;
    shadow.why = !lights ? "there is no light" : lit ? "lights and surfaces they shine on" : "no surface is lit";
    PlannedEffect& bounce = at(Effect::kBounceRays);
    const bool found = lights || any({Effect::kSky, Effect::kUnlit});
    const bool deep = config_.image.max_depth > 1;
    bounce.called_for = deep && lit && found;
    bounce.why = !deep   ? "image.max_depth is 1"
                 : !lit  ? "no surface is lit"
                 : found ? "surfaces send on light"
                         : "there is no light to find";
    shadow.callers = shadow.called_for ? 1 : 0;
    bounce.callers = bounce.called_for ? 1 : 0;
  }

  void costs(Effect effect, EffectCost& cost) const {
    const auto depth = plan_.on(Effect::kBounceRays) ? static_cast<std::uint32_t>(config_.image.max_depth) : 1u;
    const ShadingConfig& shading = config_.shading;
    const auto shade = static_cast<std::uint32_t>(shading.cycles_per_shade);
    cost.texture_reads = texture_reads(effect);
    if (std::find(kExtraEffects.begin(), kExtraEffects.end(), effect) != kExtraEffects.end())
      cost.cycles_per_hit = static_cast<std::uint32_t>(shading.cycles_per_effect);
    if (effect == Effect::kAlphaMask || effect == Effect::kAlphaBlend) {
      const bool by_shader = config_.testers.any_hit == TestersConfig::AnyHit::kShader;
      cost.cycles_per_hit = static_cast<std::uint32_t>(
          by_shader ? shading.cycles_per_any_hit : config_.testers.units[UnitKind::kAnyHit].interval_cycles);
    }
    if (effect == Effect::kShadowRays) {
      cost.rays_per_path = depth;
      cost.path_state_bytes = depth * static_cast<std::uint32_t>(sizeof(Vec3));
    }
    if (effect == Effect::kBounceRays) cost.rays_per_path = depth - 1;
    cost.cycles_per_path = cost.rays_per_path * shade;
    if (effect == Effect::kVolume) cost.path_state_bytes = sizeof(std::uint32_t);
  }

  const scene::Scene& scene_;
  const Config& config_;
  std::vector<bool> reached_;
  EffectsPlan plan_;
};

/// What a list does not name.
std::vector<Effect> left_out(const ShadingConfig::Effects& choice) {
  std::vector<Effect> out;
  if (choice.choice != ShadingConfig::Effects::Choice::kList) return out;
  for (std::size_t i = 0; i < kEffects; ++i)
    if (std::find(choice.names.begin(), choice.names.end(), kEffectNames[i]) == choice.names.end())
      out.push_back(static_cast<Effect>(i));
  return out;
}

}  // namespace

std::uint32_t EffectsPlan::path_state_bytes() const {
  std::uint32_t bytes = sizeof(PathState) + sizeof(std::uint32_t);
  for (const PlannedEffect& effect : effects) bytes += effect.cost.path_state_bytes;
  return bytes;
}

EffectsPlan plan_effects(const scene::Scene& scene, const Config& config) {
  return Planner(scene, config).plan();
}

void strip_effects(scene::Scene& scene, const ShadingConfig::Effects& choice) {
  for (const Effect effect : left_out(choice)) {
    for (Material& material : scene.materials) disable(effect, material);
    if (effect == Effect::kVertexColor)
      for (scene::Mesh& mesh : scene.meshes) mesh.colors.clear();
    if (effect == Effect::kSky) scene.sky.radiance = Vec3{0};
    if (const auto kind = light_kind(effect))
      std::erase_if(scene.lights, [&](const scene::PunctualLight& light) { return light.kind == *kind; });
  }
}

std::vector<bool> images_read(const scene::Scene& scene, const ShadingConfig::Effects& choice) {
  std::vector<bool> read(scene.images.size(), choice.choice == ShadingConfig::Effects::Choice::kAll);
  const std::vector<bool> reached = reached_materials(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (!reached[i]) continue;
    Material material = scene.materials[i];
    for (const Effect effect : left_out(choice)) disable(effect, material);
    for (const scene::TextureUse& use : textures_read(material))
      read[scene.textures[use.texture.value].image.value] = true;
  }
  return read;
}

}  // namespace carousel::shading

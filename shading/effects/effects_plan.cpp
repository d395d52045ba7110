#include "shading/effects/effects_plan.h"

#include <algorithm>

#include <fmt/format.h>

#include "shading/path/path_pool.h"
#include "shading/surface/material_properties.h"

namespace carousel::shading {

namespace {

using scene::Material;
using Choice = ShadingConfig::Effects::Choice;

bool is_left_out(Effect effect, const ShadingConfig::Effects& choice) {
  return choice.choice == Choice::kList &&
         std::find(choice.names.begin(), choice.names.end(), effect_name(effect)) == choice.names.end();
}

void disable_left_out(Material& material, const ShadingConfig::Effects& choice) {
  for (const EffectRule& rule : effect_rules())
    if (rule.disable_in_material != nullptr && is_left_out(rule.effect, choice)) rule.disable_in_material(material);
}

/// Counts the callers of one effect, and names the first.
class CallerCount {
 public:
  explicit CallerCount(PlannedEffect& effect) : effect_(effect) {}
  void add(const char* kind, std::string name) {
    if (++effect_.callers == 1) effect_.why = fmt::format("{} {}", kind, name);
  }

 private:
  PlannedEffect& effect_;
};

}  // namespace

std::uint32_t EffectsPlan::path_state_bytes() const {
  std::uint32_t bytes = sizeof(PathState) + sizeof(std::uint32_t);
  for (const PlannedEffect& effect : effects) bytes += effect.cost.path_state_bytes;
  return bytes;
}

PlannedEffect find_callers(const EffectRule& rule, const PlanInput& in) {
  PlannedEffect found;
  CallerCount callers(found);
  const std::vector<Material>& materials = in.scene.materials;
  for (std::size_t i = 0; i < materials.size() && rule.material != nullptr; ++i)
    if (in.reached[i] && requires_effect(rule, materials[i]))
      callers.add("material", materials[i].name.empty() ? std::to_string(i) : materials[i].name);
  for (std::size_t i = 0; i < in.scene.meshes.size() && rule.mesh != nullptr; ++i)
    if (rule.mesh(in.scene.meshes[i])) callers.add("mesh", in.scene.meshes[i].name);
  for (std::size_t i = 0; i < in.scene.lights.size() && rule.light != nullptr; ++i)
    if (rule.light(in.scene.lights[i])) callers.add("light", std::to_string(i));
  if (rule.scene != nullptr) {
    Need need = rule.scene(in);
    found.callers = need.called_for ? 1 : 0;
    found.why = std::move(need.why);
  }
  found.called_for = found.callers > 0;
  if (found.callers > 1) found.why += fmt::format(" and {} more", found.callers - 1);
  if (found.why.empty()) found.why = "nothing calls for it";
  return found;
}

EffectCost cost_of(const EffectRule& rule, const Config& config, std::uint32_t depth) {
  EffectCost cost;
  cost.texture_reads = rule.texture_reads;
  cost.products = rule.products;
  const auto lookup = static_cast<std::uint32_t>(config.shading.cycles_per_lookup),
             rate = static_cast<std::uint32_t>(config.shading.products_per_cycle);
  cost.cycles_per_hit = lookup * rule.texture_reads + (rate == 0 ? 0 : (rule.products + rate - 1) / rate);
  if (rule.cycles_per_hit != nullptr) cost.cycles_per_hit = rule.cycles_per_hit(config);
  if (rule.rays_per_path != nullptr) cost.rays_per_path = rule.rays_per_path(depth);
  if (rule.path_state_bytes != nullptr) cost.path_state_bytes = rule.path_state_bytes(depth);
  cost.cycles_per_path = cost.rays_per_path * static_cast<std::uint32_t>(config.shading.cycles_per_shade);
  return cost;
}

EffectsPlan plan_effects(const scene::Scene& scene, const Config& config) {
  EffectsPlan plan;
  const ShadingConfig::Effects& choice = config.shading.effects;
  plan.everything = choice.choice == Choice::kAll;
  const std::vector<bool> reached = reached_materials(scene);
  for (std::size_t i = 0; i < kEffects; ++i)
    plan.effects[i] = find_callers(effect_rules()[i], {scene, config, reached, plan});
  for (std::size_t i = 0; i < kEffects; ++i) {
    PlannedEffect& effect = plan.effects[i];
    const bool left_out = is_left_out(static_cast<Effect>(i), choice);
    effect.on = plan.everything || (effect.called_for && !left_out);
    if (left_out && effect.called_for) effect.why += "; left out by shading.effects";
  }
  const auto depth = plan.on(Effect::kBounceRays) ? static_cast<std::uint32_t>(config.image.max_depth) : 1u;
  for (std::size_t i = 0; i < kEffects; ++i)
    if (plan.effects[i].on) plan.effects[i].cost = cost_of(effect_rules()[i], config, depth);
  return plan;
}

void strip_effects(scene::Scene& scene, const ShadingConfig::Effects& choice) {
  for (Material& material : scene.materials) disable_left_out(material, choice);
  for (const EffectRule& rule : effect_rules())
    if (rule.disable_in_scene != nullptr && is_left_out(rule.effect, choice)) rule.disable_in_scene(scene);
}

std::vector<bool> images_read(const scene::Scene& scene, const ShadingConfig::Effects& choice) {
  std::vector<bool> read(scene.images.size(), choice.choice == Choice::kAll);
  const std::vector<bool> reached = reached_materials(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (!reached[i]) continue;
    Material material = scene.materials[i];
    disable_left_out(material, choice);
    for (const scene::TextureUse& use : textures_read(material))
      read[scene.textures[use.texture.value].image.value] = true;
  }
  return read;
}

}  // namespace carousel::shading

#include "app/build_report/effects.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "shading/tracer/surface_class.h"

namespace carousel::app {

namespace {

std::string choice_text(const ShadingConfig::Effects& effects) {
  using Choice = ShadingConfig::Effects::Choice;
  if (effects.choice == Choice::kList) return fmt::format("[{}]", fmt::join(effects.names, ", "));
  return effects.choice == Choice::kAll ? "all" : "auto";
}

}  // namespace

std::vector<report::Effect> effects_of(const shading::EffectsPlan& plan) {
  std::vector<report::Effect> out;
  for (std::size_t i = 0; i < kEffects; ++i) {
    const shading::PlannedEffect& e = plan.effects[i];
    out.push_back({std::string(kEffectNames[i]),
                   e.on,
                   e.called_for,
                   e.callers,
                   e.why,
                   {e.cost.rays_per_path, e.cost.texture_reads, e.cost.products, e.cost.path_state_bytes,
                    e.cost.cycles_per_hit, e.cost.cycles_per_path}});
  }
  return out;
}

void add_effects(report::Shading& out, const scene::Scene& scene, const Config& config) {
  const shading::EffectsPlan plan = shading::plan_effects(scene, config);
  Config everything = config;
  everything.shading.effects = {ShadingConfig::Effects::Choice::kAll, {}};
  const std::uint32_t most = shading::plan_effects(scene, everything).path_state_bytes();
  out.effects = effects_of(plan);
  out.effects_choice = choice_text(config.shading.effects);
  out.path_state_bytes = plan.path_state_bytes();
  const std::vector<bool> read = shading::images_read(scene, config.shading.effects);
  out.saved = {most - plan.path_state_bytes(), static_cast<std::uint64_t>(std::count(read.begin(), read.end(), false))};
  for (const auto& [surface, count] : shading::count_classes(scene, plan))
    out.classes.push_back({std::string(shading::class_name(surface)), count});
}

}  // namespace carousel::app

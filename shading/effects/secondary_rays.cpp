#include "shading/effects/secondary_rays.h"

#include <initializer_list>

#include <fmt/format.h>

#include "shading/effects/effects_plan.h"
#include "shading/surface/pane.h"

namespace carousel::shading {

namespace {

bool any_called_for(const EffectsPlan& plan, std::initializer_list<Effect> effects) {
  for (const Effect effect : effects)
    if (plan.of(effect).called_for) return true;
  return false;
}
bool has_light(const PlanInput& in) {
  return any_called_for(in.so_far, {Effect::kPointLights, Effect::kSpotLights, Effect::kDirectionalLights,
                                    Effect::kAreaLights, Effect::kEnvironmentMap});
}
bool has_lit_surface(const PlanInput& in) {
  for (std::size_t i = 0; i < in.scene.materials.size(); ++i)
    if (in.reached[i] && !in.scene.materials[i].unlit) return true;
  return false;
}

}  // namespace

Need shadow_rays(const PlanInput& in) {
  if (!has_light(in)) return {false, "there is no light"};
  if (!has_lit_surface(in)) return {false, "no surface is lit"};
  return {true, "lights and surfaces they shine on"};
}
Need bounce_rays(const PlanInput& in) {
  if (in.config.image.max_depth <= 1) return {false, "image.max_depth is 1"};
  if (!has_lit_surface(in)) return {false, "no surface is lit"};
  if (!has_light(in) && !any_called_for(in.so_far, {Effect::kSky, Effect::kUnlit}))
    return {false, "there is no light to find"};
  return {true, "surfaces send on light"};
}

Need transparent_shadows(const PlanInput& in) {
  if (!in.so_far.of(Effect::kShadowRays).called_for) return {false, "there are no shadow rays"};
  if (in.config.image.max_depth <= 2) return {false, "image.max_depth is less than 3"};
  for (std::size_t i = 0; i < in.scene.materials.size(); ++i)
    if (in.reached[i] && is_pane(in.scene.materials[i]))
      return {true, fmt::format("material '{}', a smooth thin wall", in.scene.materials[i].name)};
  return {false, "no smooth thin wall lets light through"};
}

}  // namespace carousel::shading

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/types/effect.h"
#include "scene/model/scene.h"
#include "shading/effects/effect_rule.h"

namespace carousel::shading {

/// The costs of an effect where it occurs; all 0 if it is off.
struct EffectCost {
  std::uint32_t rays_per_path = 0;     ///< at most
  std::uint32_t texture_reads = 0;     ///< filtered lookups at a hit, at most
  std::uint32_t products = 0;          ///< at a hit, beyond those of a plain surface
  std::uint32_t path_state_bytes = 0;  ///< bytes in the state of a path in flight
  std::uint32_t cycles_per_hit = 0;    ///< cycles of a simulated shader worker or opacity unit, at a surface with it
  std::uint32_t cycles_per_path = 0;   ///< most cycles of simulated shader workers for its rays, their tests apart
};

struct PlannedEffect {
  bool called_for = false;    ///< by something that can be reached from the instances
  bool on = false;            ///< the frame computes the effect
  std::uint32_t callers = 0;  ///< materials, lights or meshes that call for it
  std::string why;            ///< names the first caller, or says that nothing calls for the effect
  EffectCost cost;
};

/// The effects that a frame computes, and the reasons: `shading.effects`.
struct EffectsPlan {
  std::array<PlannedEffect, kEffects> effects;
  bool everything = false;  ///< `all`: every material is shaded by the code that has every effect

  const PlannedEffect& of(Effect effect) const { return effects[static_cast<std::size_t>(effect)]; }
  bool on(Effect effect) const { return of(effect).on; }
  /// Bytes of a path in flight, with the needs of all effects that are on.
  std::uint32_t path_state_bytes() const;
};

/// Looks at materials on triangles of instances, at lights, sky and camera, by effect_rules(). An effect that a list
/// names but nothing calls for is off. `scene` may have been through strip_effects().
EffectsPlan plan_effects(const scene::Scene& scene, const Config& config);

/// One row of the plan: the callers of the effect, without its cost, and `on` not yet set.
PlannedEffect find_callers(const EffectRule& rule, const PlanInput& in);
/// The cost of an effect that is on, in paths of `depth` surfaces.
EffectCost cost_of(const EffectRule& rule, const Config& config, std::uint32_t depth);

/// Removes from the scene the textures, layers and lights of the effects that a list does not name. Without a list
/// nothing changes. A material without `transmission` is opaque, without `refraction` a thin wall, without `mirror` no
/// smoother than roughness 0.3, without `reflection` matte.
void strip_effects(scene::Scene& scene, const ShadingConfig::Effects& choice);

/// By image: true if a material on a primitive of an instance reads a texture of it once strip_effects() has been
/// called with this choice (which may be before or after). With `all`, every image counts as read. Reads no pixels.
std::vector<bool> images_read(const scene::Scene& scene, const ShadingConfig::Effects& choice);

}  // namespace carousel::shading

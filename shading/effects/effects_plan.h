#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/types/effect.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// What an effect costs where it occurs; all 0 where it is off.
struct EffectCost {
  std::uint32_t rays_per_path = 0;     ///< at most
  std::uint32_t texture_reads = 0;     ///< filtered lookups at a hit, at most
  std::uint32_t path_state_bytes = 0;  ///< a path in flight
  std::uint32_t cycles_per_hit = 0;    ///< of a simulated shader worker or opacity unit, at a surface that has it
  std::uint32_t cycles_per_path = 0;   ///< of simulated shader workers for its rays, at most; not the rays' tests
};

/// Each takes `shading.cycles_per_effect` at a hit, in the cycle engine.
inline constexpr std::array kExtraEffects{Effect::kBaseColorTexture,
                                          Effect::kMetallicRoughnessTexture,
                                          Effect::kNormalMap,
                                          Effect::kTransmission,
                                          Effect::kRefraction,
                                          Effect::kVolume,
                                          Effect::kIor,
                                          Effect::kSpecular,
                                          Effect::kClearcoat,
                                          Effect::kSheen,
                                          Effect::kIridescence,
                                          Effect::kAnisotropy};

struct PlannedEffect {
  bool called_for = false;    ///< by what can be reached from the instances
  bool on = false;            ///< computed: called for or `all`, and not left out of a list
  std::uint32_t callers = 0;  ///< materials, lights or meshes that call for it
  std::string why;            ///< which, or that nothing does
  EffectCost cost;
};

/// Which effects a frame computes, and why: `shading.effects`.
struct EffectsPlan {
  std::array<PlannedEffect, kEffects> effects;
  bool everything = false;  ///< `all`: nothing is specialised

  const PlannedEffect& of(Effect effect) const { return effects[static_cast<std::size_t>(effect)]; }
  bool on(Effect effect) const { return of(effect).on; }
  /// A path in flight, all effects together.
  std::uint32_t path_state_bytes() const;
};

/// Looks at materials on triangles of instances, at lights, sky and camera. What a list names but nothing calls for is
/// off. `scene` may have been through strip_effects().
EffectsPlan plan_effects(const scene::Scene& scene, const Config& config);

/// Takes out of the scene what a list of effects does not name, as far as it stands in the scene: textures, layers,
/// lights. Without a list nothing changes. A material without `transmission` is opaque, without `refraction` a thin
/// wall, without `mirror` no smoother than roughness 0.3, without `reflection` matte.
void strip_effects(scene::Scene& scene, const ShadingConfig::Effects& choice);

/// By image: whether a material on a primitive of an instance has a texture of it that is read, once strip_effects()
/// has been called with this choice (which may be before or after); all, if that is `all`. Reads no pixels.
std::vector<bool> images_read(const scene::Scene& scene, const ShadingConfig::Effects& choice);

}  // namespace carousel::shading

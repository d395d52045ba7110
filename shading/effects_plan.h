#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/config.h"
#include "core/effect.h"
#include "scene/scene.h"

namespace carousel::shading {

/// What an effect costs where it occurs; all 0 where it is off.
struct EffectCost {
  std::uint32_t rays_per_path = 0;      ///< at most
  std::uint32_t texture_reads = 0;      ///< filtered lookups at a hit, at most
  std::uint32_t path_state_bytes = 0;   ///< a path in flight
};

struct PlannedEffect {
  bool called_for = false;      ///< by what can be reached from the instances
  bool on = false;              ///< computed: called for or `all`, and not left out of a list
  std::uint32_t callers = 0;    ///< materials, lights or meshes that call for it
  std::string why;              ///< which, or that nothing does
  EffectCost cost;
};

/// Which effects a frame computes, and why: `shading.effects`.
struct EffectsPlan {
  std::array<PlannedEffect, kEffects> effects;
  bool everything = false;   ///< `all`: nothing is specialised

  const PlannedEffect& of(Effect effect) const { return effects[static_cast<std::size_t>(effect)]; }
  bool on(Effect effect) const { return of(effect).on; }
  /// A path in flight, all effects together.
  std::uint32_t path_state_bytes() const;
};

/// Looks at materials on triangles of instances, at lights, sky and camera. What a list names but nothing calls for is
/// off. `scene` may have been through keep_effects().
EffectsPlan plan_effects(const scene::Scene& scene, const Config& config);

/// Takes out of the scene what a list of effects does not name, as far as it stands in the scene: textures, layers,
/// lights. Without a list nothing changes. A material without `transmission` is opaque, without `refraction` a thin
/// wall, without `mirror` no smoother than roughness 0.3, without `reflection` matte.
void keep_effects(scene::Scene& scene, const ShadingConfig::Effects& choice);

/// Empties images that no material on a triangle of an instance reads, and says how many bytes that freed. Call after
/// keep_effects().
std::uint64_t drop_unread_images(scene::Scene& scene);

/// What a material needs of the shader: the least of these that has it is chosen once, not at each hit.
enum class SurfaceClass : std::uint8_t {
  kUnlit,
  kPlain,             ///< metallic-roughness of the factors alone
  kTextured,          ///< and textures, normal map or vertex colours
  kLayered,           ///< and clearcoat or sheen
  kOpaque,            ///< ior, specular, iridescence or anisotropy
  kLayeredOpaque,
  kTransmissive,
  kLayeredTransmissive,
  kAnything,          ///< asks at each hit what there is: `all`
};
inline constexpr std::size_t kSurfaceClasses = 9;
std::string_view class_name(SurfaceClass surface);
/// Classes of the materials on triangles of instances, as the plan has them shaded, each with how many; none of 0.
std::vector<std::pair<SurfaceClass, std::uint32_t>> count_classes(const scene::Scene& scene, const EffectsPlan& plan);
/// By material: effects to be computed at a hit beyond those of a plain surface: textures, and what glTF's extensions add;
/// with `all` as many as there are.
std::vector<std::uint32_t> extra_effects(const scene::Scene& scene, const EffectsPlan& plan);
/// By material: how the plan has it shaded.
std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan);

bool has_layers(const scene::Material& material);      ///< clearcoat or sheen
bool has_interface(const scene::Material& material);   ///< a boundary that glTF's core does not describe
bool has_volume(const scene::Material& material);      ///< transmits into what it is the hull of
bool refracts(const scene::Material& material);        ///< and that is of another index of refraction
bool absorbs(const scene::Material& material);         ///< and that takes some of the light

}  // namespace carousel::shading

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/types/effect.h"
#include "scene/model/scene.h"

namespace carousel::shading {

struct EffectsPlan;

/// Parts of the shading code that a surface needs beyond a plain metallic-roughness lobe; a set of bits.
enum ShaderParts : std::uint8_t {
  kNoParts = 0,
  kTextures = 1,      ///< textures, normal maps and vertex colours
  kLayers = 2,        ///< clearcoat and sheen
  kBoundary = 4,      ///< a boundary that glTF's core does not describe
  kTransmission = 8,  ///< light passes through
};
constexpr ShaderParts operator|(ShaderParts a, ShaderParts b) {
  return static_cast<ShaderParts>(std::uint8_t{a} | std::uint8_t{b});
}

/// A rule of the whole scene sees this. `so_far` holds the effects that stand earlier in the table.
struct PlanInput {
  const scene::Scene& scene;
  const Config& config;
  const std::vector<bool>& reached;  ///< by material: reached_materials()
  const EffectsPlan& so_far;
};

struct Need {
  bool called_for = false;
  std::string why;  ///< empty: nothing calls for the effect
};

/// Everything that the plan, the scene's preparation and the choice of shader class know of one effect. A null
/// function stands for "no" or "nothing".
struct EffectRule {
  Effect effect;

  /// Each material, mesh or light for which the predicate holds calls for the effect; at most one predicate is given.
  /// `scene` serves effects that depend on the sky, the configuration or other effects.
  bool (*material)(const scene::Material&) = nullptr;
  bool (*mesh)(const scene::Mesh&) = nullptr;
  bool (*light)(const scene::PunctualLight&) = nullptr;
  Need (*scene)(const PlanInput&) = nullptr;
  bool unlit_too = false;        ///< unlit materials can have the effect
  bool dielectric_only = false;  ///< a material that is metal everywhere does not call for it

  /// Afterwards the material, or the scene, does not call for the effect.
  void (*disable_in_material)(scene::Material&) = nullptr;
  void (*disable_in_scene)(scene::Scene&) = nullptr;

  ShaderParts shader = kNoParts;  ///< code that a material (or a mesh's materials) with the effect is shaded by
  /// Appends the textures that shading reads for the effect.
  void (*textures)(const scene::Material&, std::vector<scene::TextureUse>&) = nullptr;

  /// The costs where the effect occurs. `depth` is the number of surfaces of a path.
  std::uint32_t texture_reads = 0;  ///< filtered lookups at a hit, at most
  /// Products, divisions and roots of the shading code at a hit beyond a plain surface's (set-up, one sample, two
  /// evaluations, every branch taken); a sine, exponential or power counts as the 8 or 16 of its polynomial. 0: the
  /// effect is part of a plain hit, or is no work of the shader.
  std::uint32_t products = 0;
  std::uint32_t miss_products = 0;  ///< likewise at a ray that leaves the scene, which makes texture_reads as well
  bool evaluated_without =
      false;  ///< with `effects: all` also at surfaces that do not have it; others are only checked
  std::uint32_t (*cycles_per_hit)(const Config&) = nullptr;    ///< replaces lookups and products: not a shader's work
  std::uint32_t (*rays_per_path)(std::uint32_t) = nullptr;     ///< by depth, at most
  std::uint32_t (*path_state_bytes)(std::uint32_t) = nullptr;  ///< by depth, of a path in flight
};

/// The rules of all effects, in the order of the enum.
std::span<const EffectRule, kEffects> effect_rules();
const EffectRule& rule_of(Effect effect);

/// True if the material has the effect; `dielectric_only` is not considered.
bool has_effect(const EffectRule& rule, const scene::Material& material);
/// True if the material calls for the effect.
bool requires_effect(const EffectRule& rule, const scene::Material& material);

/// With `effects: all`, a check for an effect that the surface does not have takes as long as a product.
inline constexpr std::uint32_t kCheckProducts = 1;

/// Code that the material needs, without that of its meshes.
ShaderParts shader_parts(const scene::Material& material);
/// Every texture that shading reads.
std::vector<scene::TextureUse> textures_read(const scene::Material& material);

}  // namespace carousel::shading

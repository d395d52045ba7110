#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace carousel {

/// An effect of light, surfaces or cameras. A scene calls for some effects, and `shading.effects` may choose among
/// them. A new effect takes a value here, its name below, and its row in shading/effects/effect_rules.cpp.
enum class Effect : std::uint8_t {
  kBaseColorTexture,
  kMetallicRoughnessTexture,
  kNormalMap,
  kVertexColor,
  kReflection,
  kMirror,
  kEmission,
  kTransmission,
  kRefraction,
  kVolume,
  kIor,
  kSpecular,
  kClearcoat,
  kSheen,
  kIridescence,
  kAnisotropy,
  kAlphaMask,
  kAlphaBlend,
  kDoubleSided,
  kUnlit,
  kPointLights,
  kSpotLights,
  kDirectionalLights,
  kAreaLights,
  kSky,
  kEnvironmentMap,
  kDepthOfField,
  kShadowRays,
  kBounceRays,
  kTransparentShadows,
};

/// In the order of the enum.
inline constexpr auto kEffectNames = std::to_array<std::string_view>({"base_color_texture",
                                                                      "metallic_roughness_texture",
                                                                      "normal_map",
                                                                      "vertex_color",
                                                                      "reflection",
                                                                      "mirror",
                                                                      "emission",
                                                                      "transmission",
                                                                      "refraction",
                                                                      "volume",
                                                                      "ior",
                                                                      "specular",
                                                                      "clearcoat",
                                                                      "sheen",
                                                                      "iridescence",
                                                                      "anisotropy",
                                                                      "alpha_mask",
                                                                      "alpha_blend",
                                                                      "double_sided",
                                                                      "unlit",
                                                                      "point_lights",
                                                                      "spot_lights",
                                                                      "directional_lights",
                                                                      "area_lights",
                                                                      "sky",
                                                                      "environment_map",
                                                                      "depth_of_field",
                                                                      "shadow_rays",
                                                                      "bounce_rays",
                                                                      "transparent_shadows"});
inline constexpr std::size_t kEffects = kEffectNames.size();

constexpr std::string_view effect_name(Effect effect) {
  return kEffectNames[static_cast<std::size_t>(effect)];
}

constexpr std::optional<Effect> effect_named(std::string_view name) {
  for (std::size_t i = 0; i < kEffects; ++i)
    if (kEffectNames[i] == name) return static_cast<Effect>(i);
  return std::nullopt;
}

}  // namespace carousel

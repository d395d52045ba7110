#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/model/scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::shading {

/// What a material needs of the shader: the least of these that has it is chosen once, not at each hit.
enum class SurfaceClass : std::uint8_t {
  kUnlit,
  kPlain,     ///< metallic-roughness of the factors alone
  kTextured,  ///< and textures, normal map or vertex colours
  kLayered,   ///< and clearcoat or sheen
  kOpaque,    ///< ior, specular, iridescence or anisotropy
  kLayeredOpaque,
  kTransmissive,
  kLayeredTransmissive,
  kAnything,  ///< asks at each hit what there is: `all`
};
inline constexpr std::size_t kSurfaceClasses = 9;
std::string_view class_name(SurfaceClass surface);
/// Classes of the materials on triangles of instances, as the plan has them shaded, each with how many; none of 0.
std::vector<std::pair<SurfaceClass, std::uint32_t>> count_classes(const scene::Scene& scene, const EffectsPlan& plan);
/// By material: effects to be computed at a hit beyond those of a plain surface: textures, and what glTF's extensions
/// add; with `all` as many as there are.
std::vector<std::uint32_t> extra_effects(const scene::Scene& scene, const EffectsPlan& plan);
/// By material: how the plan has it shaded.
std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan);

}  // namespace carousel::shading

#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "core/types/workload.h"
#include "scene/model/scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::shading {

/// The shading code of a material. The least code that has every effect of the material is chosen once per scene,
/// not at each hit.
enum class SurfaceClass : std::uint8_t {
  kUnlit,
  kPlain,     ///< metallic-roughness of the factors alone
  kTextured,  ///< also textures, normal map or vertex colours
  kLayered,   ///< also clearcoat or sheen
  kOpaque,    ///< ior, specular, iridescence or anisotropy
  kLayeredOpaque,
  kTransmissive,
  kLayeredTransmissive,
  kAnything,  ///< looks up at each hit which effects the material has: `all`
};
inline constexpr std::size_t kSurfaceClasses = 9;
std::string_view class_name(SurfaceClass surface);

/// By material: the shading code that the plan chooses.
std::vector<SurfaceClass> surface_classes(const scene::Scene& scene, const EffectsPlan& plan);
/// The classes of the materials on triangles of instances, each with the number of its materials; none with 0.
std::vector<std::pair<SurfaceClass, std::uint32_t>> count_classes(const scene::Scene& scene, const EffectsPlan& plan);
/// By material: the parts of the shading code that it needs, by its own effects and by those of its meshes.
std::vector<ShaderParts> parts_of_materials(const scene::Scene& scene);
/// By material: the lookups and products of a hit beyond those of a plain surface. With `all` the effects that the
/// material does not have count as well: as checks, or in full if the code evaluates them without a check.
std::vector<ShadeWork> extra_work(const scene::Scene& scene, const EffectsPlan& plan);
/// Likewise of a ray that leaves the scene, other than a shadow ray.
ShadeWork extra_work_of_misses(const EffectsPlan& plan);

}  // namespace carousel::shading

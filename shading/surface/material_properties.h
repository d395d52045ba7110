#pragma once

#include <vector>

#include "scene/model/scene.h"

namespace carousel::shading {

/// A roughness this small is shaded as a perfect mirror; its square is the least alpha of the GGX lobe.
inline constexpr float kMirrorRoughness = 0.0316f;

/// True if some point of the surface may be other than metal: a metallic-roughness texture can override the factor.
bool may_be_dielectric(const scene::Material& material);
/// True if some light passes through the surface.
bool transmits(const scene::Material& material);
/// True if light that passes through the surface enters a volume rather than crossing a thin wall.
bool has_volume(const scene::Material& material);
/// True if the volume has another index of refraction than its surroundings.
bool refracts(const scene::Material& material);
/// True if the volume absorbs light.
bool absorbs(const scene::Material& material);

/// By material: true if a primitive of some instance has it.
std::vector<bool> reached_materials(const scene::Scene& scene);

}  // namespace carousel::shading

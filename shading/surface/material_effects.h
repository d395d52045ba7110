#pragma once

#include <vector>

#include "core/types/effect.h"
#include "scene/model/scene.h"

namespace carousel::shading {

// What a material asks of whoever shades it.

/// Whether it calls for an effect; false for effects that are none of a material's.
bool requires_effect(const scene::Material& material, Effect effect);
/// Afterwards it does not; what stands in its place: strip_effects(). Nothing for effects that are none of a
/// material's.
void disable(Effect effect, scene::Material& material);

bool has_layers(const scene::Material& material);     ///< clearcoat or sheen
bool has_interface(const scene::Material& material);  ///< a boundary that glTF's core does not describe
bool transmits(const scene::Material& material);      ///< lets light through somewhere
bool has_volume(const scene::Material& material);     ///< and that into what it is the hull of
bool refracts(const scene::Material& material);       ///< and that is of another index of refraction
bool absorbs(const scene::Material& material);        ///< and that takes some of the light

/// Every texture that shading reads.
std::vector<scene::TextureUse> textures_read(const scene::Material& material);

/// By material: whether a primitive of an instance has it.
std::vector<bool> reached_materials(const scene::Scene& scene);

}  // namespace carousel::shading

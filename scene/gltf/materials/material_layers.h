#pragma once

#include <string>

#include "scene/gltf/document/document.h"
#include "scene/gltf/materials/textures.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Reads the extensions KHR_materials_ior, transmission, volume, specular, clearcoat, sheen, iridescence and anisotropy
/// of a material. `extensions` is its `extensions` object at JSON path `path`, perhaps empty. A layer whose weight is 0
/// keeps its defaults, since its other values have no effect.
void read_material_layers(const Json& extensions, const std::string& path, TextureReader& textures, Material& to);

}  // namespace carousel::scene

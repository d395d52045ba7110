#pragma once

#include <cstddef>
#include <vector>

#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Fills textures and materials of `scene`: material i is the file's, one more at the end is glTF's default material.
/// Factors outside the range their specification names are moved to its nearest end. What a factor of zero switches
/// off is not there, textures included. Returns which images of the file the textures need, in the order of
/// Texture::image; nothing else of the file need be decoded. For a document that has passed check_schema.
std::vector<std::size_t> read_materials(const GltfDocument& document, Scene& scene, const WarningSink& warn);

}  // namespace carousel::scene

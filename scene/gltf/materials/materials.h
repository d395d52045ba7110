#pragma once

#include <cstddef>
#include <vector>

#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Fills textures and materials of `scene`: material i is the file's, one more at the end is glTF's default material.
/// Factors outside the range of the specification are clamped to it. A layer that a factor of zero turns off is left
/// out, textures included. Returns the images of the file that the textures need, in the order of Texture::image; no
/// other image of the file has to be decoded. For a document that has passed check_schema.
std::vector<std::size_t> read_materials(const GltfDocument& document, Scene& scene, const WarningSink& warn);

}  // namespace carousel::scene

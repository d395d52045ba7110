#pragma once

#include "scene/gltf_document.h"
#include "scene/gltf_model.h"
#include "scene/scene.h"
#include "scene/warnings.h"

namespace carousel::scene {

/// Fills images, textures and materials of `scene`: material i is the file's, one more at the end is glTF's
/// default material. Textures nobody uses are left out. Takes the images out of `model`.
void read_materials(const GltfDocument& document, GltfModel& model, Scene& scene, const WarningSink& warn);

}  // namespace carousel::scene

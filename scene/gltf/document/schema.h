#pragma once

#include "scene/gltf/document/document.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Replaces document.json by a copy that holds only the keys that the importer knows, each value of the right type and
/// range, each index inside the array it refers to, required keys present, whole numbers as integers. Extras and
/// unknown extensions are removed, so that tinygltf's input is bounded in depth and in kind. Throws SceneError at the
/// first wrong value; but textures, images and samplers that no material uses, and animations and skins that
/// document.posing does not use, are replaced by empty ones with a warning. What only a pose reads is removed if there
/// is none.
void check_schema(GltfDocument& document, const WarningSink& warn);

}  // namespace carousel::scene

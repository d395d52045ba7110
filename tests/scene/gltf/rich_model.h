#pragma once

#include "tests/scene/gltf/model_files.h"

namespace carousel::scene {

/// A small file that uses every feature of the importer.
GltfBuilder every_feature();

/// The file of every_feature() with some hundred triangles more, in two buffers and an image of their own beside the
/// .gltf, with dozens of instances, and objects that are read for their indices only: skins, animations, morph targets.
ModelFiles rich_model();

/// The Khronos sample in tests/data, as a modelling program wrote it.
ModelFiles sample_model();

}  // namespace carousel::scene

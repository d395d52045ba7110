#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/gltf_accessor.h"
#include "scene/gltf_document.h"
#include "scene/scene.h"

namespace carousel::scene {

/// Walks the default scene's nodes depth-first (scene 0 where none is the default, all roots where there are
/// no scenes) and adds instances, lights and cameras in that order. Instance::mesh is the file's index.
/// Throws SceneError for transforms that cannot be used and for bad EXT_mesh_gpu_instancing attributes.
void read_nodes(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                ImportBudget& budget, Scene& scene);

}  // namespace carousel::scene

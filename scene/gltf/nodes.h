#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Walks the default scene's nodes depth-first (scene 0 where none is the default, all roots where there are
/// no scenes) and adds instances, lights and cameras in that order. Instance::mesh is the file's index. A node with the
/// extra "carousel_sphere" is an instance of a mesh with one sphere; these meshes are returned and follow the file's in
/// numbering, equal ones shared. `default_material` stands where a sphere names none. Nodes that KHR_node_visibility
/// hides show neither meshes nor lights, and neither do those below them; cameras stay. A light whose node leaves it no
/// direction is left out with a warning.
/// Throws SceneError for transforms that cannot be used and for bad EXT_mesh_gpu_instancing attributes.
std::vector<Mesh> read_nodes(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                             const ImportBudget& budget, MaterialId default_material, const WarningSink& warn,
                             Scene& scene);

}  // namespace carousel::scene

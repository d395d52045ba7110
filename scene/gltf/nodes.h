#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// A mesh of the file as a node bends it.
struct BentMesh {
  std::size_t mesh = 0;
  std::optional<std::size_t> skin;
  std::vector<double> weights;  ///< one a morph target
  friend auto operator<=>(const BentMesh&, const BentMesh&) = default;
};

/// A mesh that no entry of the file's array is: a sphere, or one that a node bends.
using NodeMesh = std::variant<Mesh, BentMesh>;

/// Walks the default scene's nodes depth-first (scene 0 where none is the default, all roots where there are
/// no scenes) and adds instances, lights and cameras in that order, and the names of the nodes that show anything.
/// Instance::mesh is the file's index. A node with the
/// extra "carousel_sphere" is an instance of a mesh with one sphere; where document.posing is on, one with a skin or
/// with weights of morph targets is an instance of a bent mesh, which a skin places in the world. These meshes are
/// returned and follow the file's in numbering, equal ones shared. `default_material` stands where a sphere names none.
/// Nodes that KHR_node_visibility hides show neither meshes nor lights, and neither do those below them; cameras stay.
/// A light whose node leaves it no direction is left out with a warning. Throws SceneError for transforms that cannot
/// be used and for bad EXT_mesh_gpu_instancing attributes.
std::vector<NodeMesh> read_nodes(const GltfDocument& document, const tinygltf::Model& model,
                                 const AccessorTable& accessors, const ImportBudget& budget,
                                 MaterialId default_material, const WarningSink& warn, Scene& scene);

}  // namespace carousel::scene

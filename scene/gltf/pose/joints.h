#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include <tiny_gltf.h>

#include "core/types/vec.h"
#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"

namespace carousel::scene {

/// The matrices of the joints of a file's skins, for the transforms that its nodes have in `model`.
class JointTable {
 public:
  /// Keeps references to all arguments.
  JointTable(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
             const ImportBudget& budget);

  /// One matrix a joint: from the space of the mesh as it was bound into the world. The transform of the node that
  /// shows the mesh has no part in it (specification, 3.7.3.3). Throws SceneError. Valid as long as the table.
  const std::vector<DMat4>& of(std::size_t skin);

 private:
  const DMat4& world_of(std::size_t node);

  const GltfDocument& document_;
  const tinygltf::Model& model_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  std::vector<std::optional<std::size_t>> parents_;  ///< of nodes
  std::map<std::size_t, DMat4> worlds_;              ///< by node
  std::map<std::size_t, std::vector<DMat4>> skins_;
};

}  // namespace carousel::scene

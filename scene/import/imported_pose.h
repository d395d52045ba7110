#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/system/memory_budget.h"
#include "core/types/vec.h"
#include "scene/import/imported.h"
#include "scene/model/pose_choice.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Gives the nodes the transforms that the played animations have at the moment. Of several, one that moves a node
/// which an earlier one moves is left out with a warning, as in glTF. Throws a ConfigError for the name of an
/// animation, and std::runtime_error where the parts of an animation do not fit together.
void pose_nodes(Imported& imported, const PoseChoice& pose, const std::string& file, const WarningSink& warn);

/// Moves the vertices of a mesh into the world with their bones, in double; `worlds` has the transforms of all nodes. A
/// vertex without bones moves with `own`, the node that shows the mesh. The weights of a vertex are divided by their
/// sum. Takes memory for as long as it works. Throws std::runtime_error where a bone does not fit the mesh, or a
/// position is beyond single precision.
void bend_mesh(const Imported::Skin& skin, const std::vector<DMat4>& worlds, std::size_t own, MemoryBudget& memory,
               Mesh& mesh);

}  // namespace carousel::scene

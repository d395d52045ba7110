#pragma once

#include <optional>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"
#include "scene/model/pose_choice.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Tells which animations of a file are played, by the names in its JSON as it was parsed. Without a name in `pose` it
/// is all of them. Throws a ConfigError for scene.animation.name if the file has none that is called so.
std::vector<bool> chosen_animations(const Json& json, const PoseChoice& pose, const std::string& file);
/// The same for animations of these names.
std::vector<bool> chosen_animations(const std::vector<std::string>& names, const PoseChoice& pose,
                                    const std::string& file);

/// Gives the nodes of `model` the transforms and weights that the played animations have at the time of `pose`. Of
/// several, one that moves a node which an earlier one moves is left out with a warning. Channels of extensions are
/// ignored with a warning that names them. Throws SceneError for faults of what is played.
void pose_nodes(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
                const PoseChoice& pose, const WarningSink& warn, tinygltf::Model& model);

/// What may move in the file. Faults are passed over: a length that cannot be read is 0.
Motion motion_of(const GltfDocument& document, const AccessorTable& accessors);

/// The number of morph targets of a mesh, the same for all its primitives; 0 if it has none. Throws SceneError if they
/// differ.
std::size_t morph_targets(const GltfDocument& document, const tinygltf::Model& model, std::size_t mesh);

}  // namespace carousel::scene

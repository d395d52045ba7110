#pragma once

#include <cstdint>
#include <map>
#include <string>

#include <assimp/scene.h>

#include "scene/import/imported.h"

namespace carousel::scenes {

/// The nodes of a file by their names; of several with one name the first.
using NodesByName = std::map<std::string, std::int64_t>;

/// Lists what may move: animations with their lengths, skins and morph targets.
void list_motion(const aiScene& from, scene::Imported& to);

/// Appends the keys of all animations, in seconds. Keys that go back in time are left out, and so are channels whose
/// node is not there, which a warning tells.
void read_animations(const aiScene& from, const NodesByName& nodes, scene::Imported& to);

/// Appends the bones of `from`, whose vertices begin at `first` of mesh `mesh`. The mesh's skin is the last of `to`, or
/// a new one.
void append_bones(const aiMesh& from, const NodesByName& nodes, std::uint32_t mesh, std::size_t first,
                  scene::Imported& to);

}  // namespace carousel::scenes

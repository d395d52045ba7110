#pragma once

#include <string>

#include "scene/import/imported.h"

namespace carousel::scenes {

/// Reads the scene file of a question with Assimp. Throws std::runtime_error with what Assimp says where it cannot be
/// read.
scene::Imported read_scene(const scene::ImportQuestion& question);

/// The endings of the files that Assimp reads, without glTF's, sorted, with a blank between them.
const char* endings();

}  // namespace carousel::scenes

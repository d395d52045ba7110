#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"
#include "scene/warnings.h"

namespace carousel::scene {

/// Reads a glTF 2.0 file (.gltf or .glb, told apart by content). The scene's sky is black; the caller sets
/// it. Throws SceneError naming file, JSON path and what is wrong, for whatever bytes the file holds.
Scene load_gltf(const std::filesystem::path& file, const WarningSink& warn = {});

/// The same from memory; `name` stands for the file in messages. Buffers and images must be embedded.
Scene load_gltf_from_memory(std::span<const std::byte> bytes, const std::string& name,
                            const WarningSink& warn = {});

}  // namespace carousel::scene

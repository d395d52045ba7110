#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/system/executor.h"
#include "scene/model/image_choice.h"
#include "scene/model/pose_choice.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Reads a glTF 2.0 file (.gltf or .glb, told apart by content). The scene's sky is black; the caller sets
/// it. Images that `images` excludes are not opened; without `images` every image that a material names is decoded.
/// Images are decoded on the threads of `executor`, if there is one, and else by the caller. Without `pose` skins,
/// morph targets and animations are ignored. For any contents of the file the function returns a scene or throws a
/// SceneError that names file, JSON path and error; but an animation that the file does not have is a ConfigError.
Scene load_gltf(const std::filesystem::path& file, const WarningSink& warn = {}, const ImageChoice& images = {},
                const std::optional<PoseChoice>& pose = {}, Executor* executor = nullptr);

/// Reads a glTF 2.0 file from memory, as load_gltf() does. `name` stands for the file in messages. Buffers and images
/// must be embedded.
Scene load_gltf_from_memory(std::span<const std::byte> bytes, const std::string& name, const WarningSink& warn = {},
                            const ImageChoice& images = {}, const std::optional<PoseChoice>& pose = {});

}  // namespace carousel::scene

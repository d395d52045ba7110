#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/module/module_process.h"
#include "core/system/executor.h"
#include "core/system/memory_budget.h"
#include "scene/import/import_module.h"
#include "scene/import/imported.h"
#include "scene/model/image_choice.h"
#include "scene/model/pose_choice.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// True if a file is glTF, by its ending or by its first bytes, so that load_gltf() reads it and names its faults.
bool is_gltf(const std::filesystem::path& file);

/// Reads files of other formats by the module "scenes", whose process lives as long as the object. Not for several
/// threads at once.
class SceneImporter {
 public:
  SceneImporter() : process_(ImportModule::kModule) {}

  /// The scene's sky is black, and a camera is made up where the file has none, as load_gltf() does. Images that
  /// `images` excludes are not opened. With `pose` the nodes stand as the animations have them at that moment, and
  /// skins follow their bones; without, or for morph targets, the base pose is shown. Images are decoded on the threads
  /// of `executor`, if there is one. Throws a ModuleError where the module is missing, a ConfigError for
  /// scene.animation.name if the file has none that is called so, and a SceneError for anything that is wrong with the
  /// file, a crash of the module included.
  Scene load(const std::filesystem::path& file, const WarningSink& warn = {}, const ImageChoice& images = {},
             const std::optional<PoseChoice>& pose = {}, Executor* executor = nullptr);

  /// The files that the model consists of, itself first: material files, pictures and all else that it names, whether
  /// they are there or not. Throws as load() does.
  std::vector<std::filesystem::path> files_of(const std::filesystem::path& file);

 private:
  Imported ask(const std::filesystem::path& file, MemoryBudget& memory, bool posed, bool files_only);

  ModuleProcess process_;
};

/// Makes a scene of what a module says, which is checked. `memory` gives what bending a mesh takes meanwhile. Throws
/// SceneError, a ConfigError for the name of an animation, and what `memory` throws.
Scene scene_of(Imported imported, const std::filesystem::path& file, const WarningSink& warn, MemoryBudget& memory,
               const std::optional<PoseChoice>& pose = {});

}  // namespace carousel::scene

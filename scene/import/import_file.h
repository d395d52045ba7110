#pragma once

#include <cstdint>
#include <filesystem>

#include "core/module/module_process.h"
#include "core/system/memory_budget.h"
#include "scene/import/import_module.h"
#include "scene/import/imported.h"
#include "scene/model/image_choice.h"
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
  /// `images` excludes are not opened. Animations, skins and morph targets are listed, and the base pose is shown.
  /// Throws a ModuleError where the module is missing, and a SceneError for anything that is wrong with the file, a
  /// crash of the module included.
  Scene load(const std::filesystem::path& file, const WarningSink& warn = {}, const ImageChoice& images = {});

 private:
  Imported ask(const std::filesystem::path& file, std::uint64_t size, MemoryBudget& memory);

  ModuleProcess process_;
};

/// Makes a scene of what a module says, which is checked. Throws SceneError.
Scene scene_of(Imported imported, const std::filesystem::path& file, const WarningSink& warn);

}  // namespace carousel::scene

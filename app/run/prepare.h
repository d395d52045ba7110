#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/load.h"
#include "scene/model/scene.h"
#include "shading/surface/alpha_test.h"

namespace carousel::app {

/// What the commands that take a configuration share.
struct ConfigArguments {
  std::string config;
  std::vector<std::string> sets;
};

/// A configuration with its scene and acceleration structure, ready to run.
struct Prepared {
  LocatedConfig located;
  std::filesystem::path config_folder;
  std::size_t threads = 1;  ///< engine.threads, or the machine's cores
  std::unique_ptr<scene::Scene> scene_storage = std::make_unique<scene::Scene>();
  scene::Scene& scene = *scene_storage;  ///< stays where it is when this is moved: others refer to it
  std::vector<std::string> warnings;     ///< of the import
  accel::Accel accel;
  std::unique_ptr<shading::AlphaTest> alpha_test;  ///< whom `accel` asks; null where nothing lets rays through
  double scene_seconds = 0, build_seconds = 0, plane_seconds = 0;

  const Config& config() const { return located.config; }
  /// Scale of entry distances, for the policy `nearest`.
  float scene_size() const;
};

/// Loads all of it; for synthetic traffic the configuration only. What would not fit the machine is refused before it
/// is loaded. Throws ConfigError, SceneError and FileError; warnings go to the log.
Prepared prepare(const ConfigArguments& arguments, const ValidateOptions& options, bool keep_hits);

/// The same for a configuration that is at hand as text; files it names are looked for in the working folder.
Prepared prepare_config(const std::string& text, const std::string& name, const std::vector<std::string>& sets = {});

/// A file that a configuration names: in the configuration's folder, else in the working one.
std::filesystem::path find_beside(const std::filesystem::path& config_folder, const std::string& file);

}  // namespace carousel::app

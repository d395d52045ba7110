#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "accel/measure/structure_size.h"
#include "accel/structure/accel.h"
#include "app/run/all_hits.h"
#include "core/config/load/ignored_keys.h"
#include "core/config/load/load.h"
#include "ringbus/transport/transport.h"
#include "scene/load_scene.h"
#include "scene/model/scene.h"
#include "shading/surface/alpha_test.h"

namespace carousel::app {

/// Arguments of all commands that take a configuration.
struct ConfigArguments {
  std::string config;
  std::vector<std::string> sets;
  bool strict = false;      ///< keys that the machine ignores are errors
  bool charge_all = false;  ///< everything is charged that has a key (app/charges/charges.h)
};

/// A configuration with its scene and acceleration structure, ready to run.
struct Prepared {
  LocatedConfig located;
  std::filesystem::path config_folder;
  std::size_t threads = 1;         ///< engine.threads, or as many as make one simulation faster
  std::size_t threads_beside = 1;  ///< engine.threads, or the machine's cores: for simulations beside each other
  std::unique_ptr<scene::Scene> scene_storage = std::make_unique<scene::Scene>();
  scene::Scene& scene = *scene_storage;  ///< keeps its address when the object is moved, since others refer to it
  std::vector<std::string> warnings;     ///< warnings of the import
  accel::Accel accel;
  std::optional<accel::StructureSize> structure;       ///< size of all ranks' shares; absent where all of it is here
  std::unique_ptr<shading::AlphaTest> alpha_test;      ///< any-hit calls of `accel`; null if every material is opaque
  std::unique_ptr<scene::OpacityMicromaps> micromaps;  ///< of `accel`; null without bvh.micromaps or opaque throughout
  std::unique_ptr<AllHits> all_hits;          ///< with rays.query: all, or nearest, those of a file's rays; else null
  std::unique_ptr<NearestHits> nearest_hits;  ///< with rays.query.nearest those of `accel`; else null
  double scene_seconds = 0, build_seconds = 0, plane_seconds = 0;

  const Config& config() const { return located.config; }
  /// The configuration as files hold it, so that it runs again from any folder: the names of its files are absolute.
  Config absolute_config() const;
  /// The keys that the user sets and the machine ignores.
  std::vector<IgnoredKey> ignored() const;
  bool has_rays() const;  ///< true if the workload is rays, for which there is a scene
  /// Scale of entry distances, for the policy `nearest`.
  float scene_size() const;
};

/// Loads configuration, scene and structure; for synthetic traffic the configuration only. Refuses a scene that would
/// not fit into the machine's memory before loading it. `before_scene` is called with what has the configuration only,
/// then `ranks` for the way to the other ranks, null if there are none; where the scene decides how large the machine
/// is, `before_scene` is called when that is known. Throws ConfigError, SceneError and FileError; logs warnings and the
/// times of the phases.
Prepared prepare(const ConfigArguments& arguments, const ValidateOptions& options, bool keep_hits,
                 const std::function<void(const Prepared&)>& before_scene = {},
                 const std::function<ringbus::Transport*()>& ranks = {});

/// Prepares a configuration given as text, as prepare() does. Files that it names are looked for in the working folder.
Prepared prepare_config(const std::string& text, const std::string& name, const std::vector<std::string>& sets = {});

/// Gives a prepared scene another machine, that of a configuration with the same scene and structure. Refuses one that
/// exceeds its area, that does not fit the structure, or that the host's memory does not hold. Throws a ConfigError.
void set_machine(Prepared& prepared, LocatedConfig located);

/// The scene of a moment, as prepare() loads it for a configuration with that moment. Warnings that are new go to the
/// log.
scene::Scene load_moment(Prepared& prepared, float seconds);

/// Gives a prepared scene, whose content has been replaced by that of another moment, a structure that is built anew.
void rebuild(Prepared& prepared);

/// Makes the storage of the machine large enough for a structure that has become deeper. Throws a ConfigError.
void renew_room(Prepared& prepared);

/// Lets the structure, which fits the scene, answer any-hit calls of it as it now is.
void renew_any_hit(Prepared& prepared);

/// The view of the configured picture.
inline scene::View view_of(const Config& config) {
  return {config.camera, static_cast<float>(config.image.width) / static_cast<float>(config.image.height)};
}

/// Path of a file that a configuration names: in the configuration's folder, or else in the working folder.
inline std::filesystem::path find_beside(const std::filesystem::path& config_folder, const std::string& file) {
  std::error_code ignored;
  const std::filesystem::path beside = config_folder / file;
  return std::filesystem::exists(beside, ignored) ? beside : std::filesystem::path(file);
}

}  // namespace carousel::app

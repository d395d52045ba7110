#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "core/config/fields/bvh.h"
#include "core/config/fields/engine.h"
#include "core/config/fields/scene.h"
#include "core/config/fields/workload.h"

namespace carousel::app {

/// The digests of the files that configurations name, each file read once.
class ContentDigests {
 public:
  /// `config_folder`: where files are looked for before the working folder.
  /// `read_again`: those who use the digest read the files again, so that a pipe, which has one reader, is refused.
  explicit ContentDigests(std::filesystem::path config_folder, bool read_again = false)
      : folder_(std::move(config_folder)), read_again_(read_again) {}

  /// The digest of the plugins, the scene's file, the files that it names, trees, and a list of rays; empty if the
  /// configuration names none. Throws FileError for files that cannot be read.
  std::string of(const EngineConfig& engine, const SceneConfig& scene, const BvhConfig& bvh,
                 const WorkloadConfig& workload);

 private:
  const std::string& of_file(const std::string& name);
  const std::string& of_scene(const std::string& name);
  void require_plain(const std::filesystem::path& path) const;

  std::filesystem::path folder_;
  bool read_again_;
  std::map<std::string, std::string> files_, scenes_;  ///< by name, as configurations give it
};

/// Version and commit of this program. A program that was built from changed sources, of which the commit says nothing,
/// is told apart by its own content.
std::string program_identity();

}  // namespace carousel::app

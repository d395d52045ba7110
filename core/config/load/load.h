#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/config/load/validate.h"
#include "core/config/tree/positions.h"

namespace carousel {

/// A configuration with the places its values came from, so that later checks can name them too.
struct LocatedConfig {
  Config config;
  KeyPositions positions;
  std::vector<std::string> plugins{};  ///< the files of engine.plugins, which are open (core/plugin/open_plugin.h)
};

/// The text of a configuration: YAML, or JSON when `name` ends in .json or the text is a JSON object.
struct ConfigText {
  std::string text;
  std::string name;  ///< the name of the text in messages
};

/// Reads a file. Throws a ConfigError for one that cannot be read.
ConfigText read_config_file(const std::filesystem::path& path);

/// Reads a configuration and applies the assignments `key.path=value` of `sets` in order. Throws a ConfigError with
/// every problem: syntax, unknown keys, types, ranges, and, unless `options` leaves them out, the rules across fields.
LocatedConfig load_config(const ConfigText& source, std::span<const std::string> sets = {},
                          const ValidateOptions& options = {});

/// Throws a ConfigError for what must not be asked of a scene that consists of Gaussians, which is known once it is
/// loaded.
void require_for_gaussians(const Config& config, const KeyPositions& positions);

}  // namespace carousel

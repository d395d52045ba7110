#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/config.h"
#include "core/config/tree/positions.h"
#include "core/config/validate.h"

namespace carousel {

/// A configuration with the places its values came from, so that later checks can name them too.
struct LocatedConfig {
  Config config;
  KeyPositions positions;
};

/// Reads text (YAML, or JSON when `name` ends in .json or the text is a JSON object) and applies the
/// assignments `key.path=value` of `sets` in order. `name` is what messages call the file. Throws a
/// ConfigError with every problem: syntax, unknown keys, types, ranges and the rules across fields.
LocatedConfig parse_located_config(std::string_view text, const std::string& name,
                                   std::span<const std::string> sets = {}, const ValidateOptions& options = {});
Config parse_config(std::string_view text, const std::string& name, std::span<const std::string> sets = {},
                    const ValidateOptions& options = {});

/// The same for a file. A file that cannot be read is a ConfigError.
LocatedConfig load_located_config(const std::filesystem::path& path, std::span<const std::string> sets = {},
                                  const ValidateOptions& options = {});
Config load_config(const std::filesystem::path& path, std::span<const std::string> sets = {},
                   const ValidateOptions& options = {});

/// The first half of parse_config: reads without the rules across fields; problems are appended to `issues`.
/// Throws a ConfigError only for text that cannot be read at all.
LocatedConfig read_config(std::string_view text, const std::string& name, std::span<const std::string> sets,
                          std::vector<ConfigIssue>& issues);

}  // namespace carousel

#pragma once

#include <string>
#include <vector>

#include "core/config/load/load.h"

namespace carousel {

inline Config parse_config(const std::string& text, const std::string& name, const std::vector<std::string>& sets = {},
                           const ValidateOptions& options = {}) {
  return load_config({text, name}, sets, options).config;
}

/// The problems of a configuration; none when it is accepted.
inline std::vector<ConfigIssue> issues_of(const std::string& text, const std::vector<std::string>& sets = {},
                                          const std::string& name = "test.yaml") {
  try {
    parse_config(text, name, sets);
  } catch (const ConfigError& error) {
    return error.issues();
  }
  return {};
}

inline std::vector<std::string> texts(const std::vector<ConfigIssue>& issues) {
  std::vector<std::string> out;
  for (const ConfigIssue& issue : issues) out.push_back(issue.text());
  return out;
}

}  // namespace carousel

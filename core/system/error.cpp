#include "core/system/error.h"

#include <utility>

#include "core/system/plain_text.h"

namespace carousel {

std::string SourcePosition::text() const {
  std::string out = file;
  if (line > 0) out += ":" + std::to_string(line);
  if (line > 0 && column > 0) out += ":" + std::to_string(column);
  return out;
}

std::string ConfigIssue::text() const {
  std::string out = position.text();
  if (!out.empty()) out += ": ";
  if (!key_path.empty()) out += key_path + ": ";
  return out + message;
}

namespace {

std::string join(const std::vector<ConfigIssue>& issues) {
  std::string out;
  for (const ConfigIssue& issue : issues) {
    if (!out.empty()) out += '\n';
    out += issue.text();
  }
  return out;
}

}  // namespace

ConfigError::ConfigError(std::vector<ConfigIssue> issues)
    : std::runtime_error(join(issues)), issues_(std::move(issues)) {}

ConfigError::ConfigError(std::string key_path, std::string message)
    : ConfigError(std::vector<ConfigIssue>{{{}, std::move(key_path), std::move(message)}}) {}

SceneError::SceneError(std::string file, std::string json_path, std::string message)
    : std::runtime_error(plain_text(file + (json_path.empty() ? "" : ": " + json_path) + ": " + message)),
      file_(std::move(file)),
      json_path_(plain_text(json_path)),
      message_(plain_text(message)) {}

}  // namespace carousel

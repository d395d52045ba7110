#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {

/// All that the report in a folder says but how the machine was named, and what the host took.
inline nlohmann::ordered_json results_of(const Program& program, const std::string& folder) {
  auto report = nlohmann::ordered_json::parse(program.read(folder + "/report.json"));
  for (const char* key : {"config", "host", "ignored_keys", "checksum", "drawing"}) report.erase(key);
  for (auto& [key, section] : report.items())
    if (section.is_object())
      for (const char* time : {"seconds", "wall_seconds", "build_seconds", "import_seconds"}) section.erase(time);
  return report;
}

}  // namespace carousel

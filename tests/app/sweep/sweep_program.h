#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {

/// The smallest machine that has all parts of a report but the search for its bottleneck.
inline constexpr const char* kTinyMachine =
    "scene: {builtin: cornell}\n"
    "image: {width: 16, height: 16, samples: 1, max_depth: 2}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\n"
    "topology: {resources: 4}\n";

/// The finished points of a folder by name, without what depends on the host. A point that is being written is none.
inline std::map<std::string, nlohmann::json> points_of(const std::filesystem::path& folder) {
  std::map<std::string, nlohmann::json> out;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "points")) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream in(entry.path());
    nlohmann::json json = nlohmann::json::parse(in);
    json.erase("host");
    json.erase("checksum");
    if (json.contains("report")) json["report"].erase("host");
    out[entry.path().filename()] = std::move(json);
  }
  return out;
}

inline std::vector<std::string> sweep_words(std::vector<std::string> more) {
  std::vector<std::string> out{"sweep", "a.yaml", "--quiet"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

}  // namespace carousel

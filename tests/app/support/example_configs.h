#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace carousel {

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Every configuration of configs/ and its folders, in order.
inline std::vector<std::filesystem::path> example_configs() {
  std::set<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(CAROUSEL_SOURCE_DIR "/configs"))
    if (const std::filesystem::path& path = entry.path();
        (path.extension() == ".yaml" || path.extension() == ".json") && path.filename() != "schema.json")
      found.insert(path);
  return {found.begin(), found.end()};
}

/// Below configs/.
inline std::string name_in_configs(const std::filesystem::path& path) {
  return std::filesystem::relative(path, CAROUSEL_SOURCE_DIR "/configs").string();
}

inline std::string example_name(const testing::TestParamInfo<std::filesystem::path>& file) {
  return std::regex_replace(name_in_configs(file.param), std::regex("\\W"), "_");
}

/// Sets by which such a configuration becomes one of a small picture of a small scene.
inline const std::vector<std::string>& small_picture() {
  static const std::vector<std::string> sets{"engine.what_if=false", "image.width=12",    "image.height=8",
                                             "image.samples=1",      "image.max_depth=2", "scene.triangles=1000",
                                             "scene.instances=50"};
  return sets;
}

inline bool has_traffic(const std::filesystem::path& path) {
  return text_of(path).find("traffic:") != std::string::npos;
}

}  // namespace carousel

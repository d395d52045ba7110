#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/module/module.h"
#include "core/system/error.h"
#include "scene/import/import_file.h"

namespace carousel::scene {

/// A folder for files, and the module.
class ImportFiles : public testing::Test {
 protected:
  ImportFiles()
      : folder_(std::filesystem::temp_directory_path() / ("carousel-import-" + std::to_string(::getpid())) / "a" /
                "b") {
    std::filesystem::create_directories(folder_);
  }
  ~ImportFiles() override { std::filesystem::remove_all(folder_.parent_path().parent_path()); }
  void SetUp() override {
    if (!std::filesystem::exists(module_folder() / "scenes.so")) GTEST_SKIP() << "built without libassimp-dev";
  }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  Scene load(const std::string& name, const std::optional<PoseChoice>& pose = {}) {
    warnings_.clear();
    const auto keep = [&](const std::string& w) {
      warnings_.push_back(w.starts_with(folder_.string() + "/") ? w.substr(folder_.string().size() + 1) : w);
    };
    return importer_.load(folder_ / name, keep, {}, pose);
  }
  std::string error_of(const std::string& name) {
    try {
      load(name);
      return "loaded";
    } catch (const SceneError& e) {
      return e.message();
    }
  }

  std::filesystem::path folder_;
  std::vector<std::string> warnings_;
  SceneImporter importer_;
};

}  // namespace carousel::scene

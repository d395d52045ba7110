#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/module/module.h"
#include "core/system/memory_budget.h"
#include "scene/images/image_decode.h"

namespace carousel::scene {

using Bytes = std::vector<unsigned char>;

inline Bytes bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A picture of 24 x 16 pixels whose colours differ from pixel to pixel.
inline const std::string kGradient =
    "--create 24x16 3 --fill:topleft=0.1,0.2,0.9:topright=0.9,0.3,0.1:bottomleft=0,1,0.5:bottomright=0.6,0.5,1 24x16";

/// Makes pictures by OpenImageIO's own tool, in a folder of its own. Skips where it or the module is missing.
class PictureFiles : public testing::Test {
 protected:
  void SetUp() override {
    // Where it is refused the tests fail.
    if (!std::filesystem::exists(module_folder() / "pictures.so")) GTEST_SKIP() << "the module pictures is not there";
    if (std::system("oiiotool --version >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "oiiotool is missing (openimageio-tools)";
    std::string name = (std::filesystem::temp_directory_path() / "carousel_pictures_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }

  /// The tool with these words, in the folder. It takes half a second: several pictures come of one call.
  void tool(const std::string& words) const {
    const std::string command = "cd '" + folder_.string() + "' && oiiotool " + words + " >tool.txt 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0)
        << words << "\n"
        << std::string(std::istreambuf_iterator<char>(std::ifstream(folder_ / "tool.txt").rdbuf()), {});
  }
  Bytes file(const std::string& name) const { return bytes_of(folder_ / name); }

  static Image decode(const Bytes& bytes, const PictureHint& hint = {}, std::uint64_t memory = 64 << 20) {
    MemoryBudget budget(memory);
    return decode_image(bytes, budget, hint);
  }
  static std::string refusal(const Bytes& bytes, const PictureHint& hint = {}, std::uint64_t memory = 64 << 20) {
    try {
      decode(bytes, hint, memory);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "decoded";
  }

  std::filesystem::path folder_;
};

}  // namespace carousel::scene

#include "scene/load_sky.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"
#include "scene/builtin/hash_random.h"
#include "tests/support/hdr_file.h"
#include "tests/support/random_runs.h"

namespace carousel::scene {
namespace {

using testing::HasSubstr;

class LoadSky : public testing::Test {
 protected:
  LoadSky() : folder_(std::filesystem::temp_directory_path() / ("carousel-sky-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~LoadSky() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  /// A picture of one row whose channels have these names and the values, pixel by pixel.
  std::filesystem::path write_exr(const std::vector<float>& values, const std::string& names = "RGB",
                                  Imf::PixelType type = Imf::FLOAT) const {
    const auto width = static_cast<int>(values.size() / names.size());
    Imf::Header header(width, 1);
    Imf::FrameBuffer buffer;
    std::vector<half> halves(values.begin(), values.end());
    const std::size_t size = type == Imf::FLOAT ? sizeof(float) : sizeof(half);
    const char* first = type == Imf::FLOAT ? reinterpret_cast<const char*>(values.data())
                                           : reinterpret_cast<const char*>(halves.data());
    for (std::size_t c = 0; c < names.size(); ++c) {
      header.channels().insert(std::string(1, names[c]), Imf::Channel(type));
      buffer.insert(std::string(1, names[c]),
                    Imf::Slice(type, const_cast<char*>(first + c * size), size * names.size(), 0));
    }
    const std::filesystem::path path = folder_ / "a.exr";
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(1);
    return path;
  }
  SkyMap load(const std::filesystem::path& file, SkyConfig config = {}) {
    warnings_.clear();
    return load_sky_map(file, config, [&](const std::string& warning) { warnings_.push_back(warning); });
  }
  std::string refusal(const std::filesystem::path& file) {
    try {
      load(file);
    } catch (const SceneError& error) {
      return error.message();
    }
    return "";
  }

  std::filesystem::path folder_;
  std::vector<std::string> warnings_;
};

TEST_F(LoadSky, StrengthMultipliesAndRotationIsInTurns) {
  SkyConfig config;
  config.strength = 3;
  config.rotation = -90;
  const SkyMap map = load(write("a.hdr", hdr_file(2, 1,
                                                  [](int x, int) {
                                                    return Vec3{1.0f + float(x), 0.5f, 0};
                                                  })),
                          config);
  EXPECT_EQ(map.name, "a.hdr");
  EXPECT_EQ(map.width, 2u);
  EXPECT_EQ(map.height, 1u);
  EXPECT_THAT(map.texels, testing::ElementsAre(Vec3(3, 1.5f, 0), Vec3(6, 1.5f, 0)));
  EXPECT_EQ(map.rotation, 0.75f);
  config.rotation = 360;
  EXPECT_EQ(load(folder_ / "a.hdr", config).rotation, 0.0f);
  EXPECT_TRUE(warnings_.empty());
  config.strength = 0;
  EXPECT_FALSE(is_lit(load(folder_ / "a.hdr", config)));
}

TEST_F(LoadSky, ReadsFloatsHalvesAndGreyOfOpenExr) {
  EXPECT_THAT(load(write_exr({1, 2, 3, 0.1f, 1e-20f, 6})).texels,
              testing::ElementsAre(Vec3(1, 2, 3), Vec3(0.1f, 1e-20f, 6)));
  EXPECT_THAT(load(write_exr({1, 2, 3, 4, 5, 6, 0.5f, 9}, "RGBA", Imf::HALF)).texels,
              testing::ElementsAre(Vec3(1, 2, 3), Vec3(5, 6, 0.5f)));
  EXPECT_THAT(load(write_exr({4, 5}, "Y")).texels, testing::ElementsAre(Vec3(4), Vec3(5)));
  EXPECT_THAT(refusal(write_exr({4, 5}, "RG")), HasSubstr("has no channels R, G and B, nor Y"));
}

TEST_F(LoadSky, ReplacesWhatIsNoLightAndCountsIt) {
  const float inf = std::numeric_limits<float>::infinity();
  const SkyMap map = load(write_exr({NAN, -1, 5, inf, 7, -inf, 2e12f, -0.0f, 1}));
  EXPECT_THAT(map.texels, testing::ElementsAre(Vec3(0, 0, 5), Vec3(7, 7, 0), Vec3(7, 0, 1)));
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(
      warnings_[0],
      HasSubstr("a.exr: of 9 values 3 are NaN or negative and count as 0, and 2 are infinite or above 1e+12 and "
                "take 7, the largest other one"));
  SkyConfig strong;
  strong.strength = 1e6f;
  EXPECT_EQ(load(write_exr({1e7f, 3, 0}), strong).texels[0], Vec3(3e6f, 3e6f, 0)) << "too bright by its strength";
  EXPECT_FALSE(is_lit(load(write_exr({inf, NAN, -1})))) << "there is no other value";
}

TEST_F(LoadSky, NamesWhatItCannotRead) {
  EXPECT_EQ(refusal(write("a.hdr", "P6\n1 1\n255\nabc")), "is no environment map: neither Radiance (.hdr) nor OpenEXR");
  EXPECT_EQ(refusal(write("a.hdr", "")), "is no environment map: neither Radiance (.hdr) nor OpenEXR");
  EXPECT_EQ(refusal(folder_ / "none.hdr"), "cannot be read");
  EXPECT_THAT(refusal(write("a.hdr", "#?RADIANCE\n")), HasSubstr("broken at byte 11: the data ends early"));
  EXPECT_THAT(refusal(write("b.exr", "\x76\x2f\x31\x01")), HasSubstr("broken, read up to byte"));
  try {
    load(folder_ / "b.exr");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.file(), (folder_ / "b.exr").string());
  }
}

TEST_F(LoadSky, ChangedOpenExrFilesLoadOrAreRefused) {
  std::vector<float> values(3 * 64);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i % 7);
  std::ifstream in(write_exr(values), std::ios::binary);
  const std::string good{std::istreambuf_iterator<char>(in), {}};
  int refused = 0;
  for (int i = 0; i < scaled(600, 200); ++i) {
    HashRandom random(run_seed() + static_cast<std::uint64_t>(i), 11);
    std::string bytes = good;
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n)
      bytes[random.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(random.below(256));
    if (random.below(4) == 0) bytes.resize(random.below(static_cast<std::uint32_t>(bytes.size())));
    refused += refusal(write("changed.exr", bytes)).empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace carousel::scene

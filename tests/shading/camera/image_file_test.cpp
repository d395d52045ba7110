#include "shading/camera/image_file.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "core/numeric/fixed_point.h"
#include "core/system/error.h"
#include "shading/camera/film.h"
#include "shading/camera/tone_curve.h"
#include "tests/support/full_disk.h"

namespace carousel::shading {
namespace {

class ImageFile : public testing::Test {
 protected:
  ImageFile() { std::filesystem::create_directories(folder_); }
  ~ImageFile() override { std::filesystem::remove_all(folder_); }
  template <class T>
  static std::vector<T> read(const std::filesystem::path& path, OIIO::TypeDesc type) {
    const auto file = OIIO::ImageInput::open(path.string());
    EXPECT_TRUE(file) << OIIO::geterror();
    if (!file) return {};
    EXPECT_EQ(file->spec().width, 2);
    EXPECT_EQ(file->spec().height, 1);
    EXPECT_EQ(file->spec().nchannels, 3);
    std::vector<T> pixels(6);
    EXPECT_TRUE(file->read_image(0, 0, 0, 3, type, pixels.data()));
    return pixels;
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      ("image_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  const std::vector<float> rgb_{0.0f, 0.18f, 1e6f, 1e-9f, 0.333333343f, 2.0f};
};

TEST_F(ImageFile, ExrKeepsEveryBit) {
  write_exr(folder_ / "a.exr", 2, 1, rgb_);
  EXPECT_EQ(read<float>(folder_ / "a.exr", OIIO::TypeDesc::FLOAT), rgb_);
}

TEST_F(ImageFile, PngIsDisplayReferred) {
  write_png(folder_ / "a.png", 2, 1, std::vector<float>{0, 0, 0, 1e9f, 1e9f, 1e9f});
  const auto pixels = read<std::uint8_t>(folder_ / "a.png", OIIO::TypeDesc::UINT8);
  EXPECT_EQ(pixels, (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}));
}

TEST_F(ImageFile, LeavesNothingElseBehind) {
  write_png(folder_ / "a.png", 2, 1, rgb_);
  write_png(folder_ / "a.png", 2, 1, rgb_);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(ImageFile, ReportsWhatCannotBeWritten) {
  EXPECT_THROW(write_png("/proc/no/such/a.png", 2, 1, rgb_), FileError);
  EXPECT_THROW(write_exr("/proc/no/such/a.exr", 2, 1, rgb_), FileError);
}

TEST_F(ImageFile, KeepsTheOldPictureWhenTheDiskIsFull) {
  EXPECT_THROW(write_png("/dev/full", 2, 1, rgb_), FileError);
  EXPECT_THROW(write_exr("/dev/full", 2, 1, rgb_), FileError);
  write_exr(folder_ / "a.exr", 2, 1, rgb_);
  write_png(folder_ / "a.png", 2, 1, rgb_);
  {
    const FullDisk full(100);
    const std::vector<float> noise(3 * 64 * 64, 0.5f);
    EXPECT_THROW(write_exr(folder_ / "a.exr", 64, 64, noise), FileError);
    EXPECT_THROW(write_png(folder_ / "a.png", 64, 64, noise), FileError);
    EXPECT_THROW(write_png(folder_ / "b.png", 64, 64, noise), FileError);
  }
  EXPECT_EQ(read<float>(folder_ / "a.exr", OIIO::TypeDesc::FLOAT), rgb_);
  EXPECT_EQ(read<std::uint8_t>(folder_ / "a.png", OIIO::TypeDesc::UINT8).size(), 6u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 2);
}

TEST(ToneCurve, KeepsMidtonesAndNeverLeavesTheDisplay) {
  const Vec3 mid = tone_curve({0.5f, 0.4f, 0.3f});
  EXPECT_NEAR(mid.x, 0.46f, 1e-6f);
  EXPECT_NEAR(mid.z, 0.26f, 1e-6f);
  float last = -1;
  for (float x = 0; x < 100; x += 0.01f) {
    const Vec3 c = tone_curve({x, 0.5f * x, 0.1f});
    EXPECT_GE(c.x, last);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(c[k], 0.0f);
      EXPECT_LE(c[k], 1.0f);
    }
    last = c.x;
  }
}

TEST(Film, AveragesOverSamples) {
  Film film(2, 1, 4);
  std::uint64_t saturated = 0;
  film.add(1, to_fixed_point(1.0f, saturated), to_fixed_point(2.0f, saturated), to_fixed_point(-1.0f, saturated));
  film.add(1, to_fixed_point(3.0f, saturated), 0, 0);
  EXPECT_EQ(film.linear_rgb(), (std::vector<float>{0, 0, 0, 1, 0.5f, -0.25f}));
}

}  // namespace
}  // namespace carousel::shading

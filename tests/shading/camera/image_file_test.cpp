#include "shading/camera/image_file.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>
#include <webp/decode.h>

#include "core/numeric/fixed_point.h"
#include "core/system/error.h"
#include "shading/camera/film.h"
#include "shading/camera/page_picture.h"
#include "shading/camera/tone_curve.h"
#include "tests/support/full_disk.h"
#include "tests/support/read_exr.h"

namespace carousel::shading {
namespace {

class ImageFile : public testing::Test {
 protected:
  ImageFile() { std::filesystem::create_directories(folder_); }
  ~ImageFile() override { std::filesystem::remove_all(folder_); }
  static std::vector<std::uint8_t> read_png(const std::filesystem::path& path) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_file(&image, path.c_str()), 0) << image.message;
    EXPECT_EQ(image.format, png_uint_32{PNG_FORMAT_RGB});
    EXPECT_EQ(image.width, 2u);
    EXPECT_EQ(image.height, 1u);
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
    EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
    return pixels;
  }
  static std::vector<float> values(const std::filesystem::path& exr) {
    const ExrPicture picture = read_exr(exr);
    EXPECT_EQ(picture.width, 2);
    EXPECT_EQ(picture.height, 1);
    EXPECT_TRUE(picture.zip);
    return picture.rgb;
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      ("image_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  const std::vector<float> rgb_{0.0f, 0.18f, 1e6f, 1e-9f, 0.333333343f, 2.0f};
};

TEST_F(ImageFile, ExrKeepsEveryBit) {
  write_exr(folder_ / "a.exr", 2, 1, rgb_);
  EXPECT_EQ(values(folder_ / "a.exr"), rgb_);
}

TEST_F(ImageFile, PngIsDisplayReferred) {
  write_png(folder_ / "a.png", 2, 1, std::vector<float>{0, 0, 0, 1e9f, 1e9f, 1e9f});
  const auto pixels = read_png(folder_ / "a.png");
  EXPECT_EQ(pixels, (std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255}));
}

TEST_F(ImageFile, PagesHoldSmallPicturesAsTheyAreAndLargeOnesReduced) {
  write_png(folder_ / "a.png", 2, 1, rgb_);
  EXPECT_EQ(page_picture(folder_ / "a.png").value().mime_type, "image/png");
  EXPECT_FALSE(page_picture(folder_ / "none.png"));
  // Noise, which PNG cannot pack.
  std::vector<float> noise(std::size_t{3} * 3300 * 300);
  std::uint32_t state = 1;
  for (float& value : noise) value = float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
  write_png(folder_ / "large.png", 3300, 300, noise);
  const auto large = page_picture(folder_ / "large.png");
  ASSERT_TRUE(large);
  EXPECT_EQ(large->mime_type, "image/webp");
  int width = 0, height = 0;
  EXPECT_TRUE(
      WebPGetInfo(reinterpret_cast<const std::uint8_t*>(large->bytes.data()), large->bytes.size(), &width, &height));
  EXPECT_EQ(width, 1100);  // the least whole step below 1,600
  EXPECT_EQ(height, 100);
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
  EXPECT_EQ(values(folder_ / "a.exr"), rgb_);
  EXPECT_EQ(read_png(folder_ / "a.png").size(), 6u);
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

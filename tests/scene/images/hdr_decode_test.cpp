#include "scene/images/hdr_decode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/builtin/hash_random.h"
#include "tests/support/hdr_file.h"
#include "tests/support/random_runs.h"

namespace carousel::scene {
namespace {

using testing::HasSubstr;

FloatImage decode(const std::string& bytes, std::uint64_t budget = 1 << 20) {
  MemoryBudget memory(budget);
  return decode_hdr({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, memory);
}

std::string refusal(const std::string& bytes) {
  try {
    decode(bytes);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

/// A row in runs a channel: the first `same` bytes of each channel as a run, the others as they are.
std::string run_row(const std::string& pixels, std::size_t same) {
  const std::size_t width = pixels.size() / 4;
  std::string out{2, 2, static_cast<char>(width >> 8), static_cast<char>(width & 255)};
  for (std::size_t c = 0; c < 4; ++c) {
    out += static_cast<char>(128 + same);
    out += pixels[c];
    out += static_cast<char>(width - same);
    for (std::size_t x = same; x < width; ++x) out += pixels[4 * x + c];
  }
  return out;
}

/// Ten pixels, of which the first five are the same.
std::string ten_pixels() {
  std::string out;
  for (int i = 0; i < 10; ++i) out += rgbe(Vec3{1, 0.5f, 0.25f} * float(1 + std::max(0, i - 4)));
  return out;
}

TEST(HdrDecode, AMantissaStandsForItsShareOf256) {
  const FloatImage image = decode(hdr_header(4, 1) + std::string("\x80\x40\xff\x81", 4) + std::string("\1\2\3\0", 4) +
                                  std::string("\1\2\3\1", 4) + std::string("\xff\0\0\xff", 4));
  ASSERT_EQ(image.pixels.size(), 4u);
  EXPECT_EQ(image.pixels[0], Vec3(1, 0.5f, 255 / 128.0f));
  EXPECT_EQ(image.pixels[1], Vec3(0)) << "an exponent of 0 is black";
  EXPECT_EQ(image.pixels[2], Vec3(0x1p-135f, 0x2p-135f, 0x3p-135f));
  EXPECT_EQ(image.pixels[3], Vec3(0x0.ffp127f, 0, 0));
}

TEST(HdrDecode, AllThreeWaysToWriteARowGiveTheSamePixels) {
  const std::string pixels = ten_pixels();
  const std::string repeat("\1\1\1\4", 4);
  const FloatImage image =
      decode(hdr_header(10, 3) + pixels + run_row(pixels, 5) + pixels.substr(0, 4) + repeat + pixels.substr(20));
  ASSERT_EQ(image.width, 10u);
  ASSERT_EQ(image.height, 3u);
  for (std::size_t x = 0; x < 10; ++x) {
    EXPECT_EQ(image.pixels[x], (Vec3{1, 0.5f, 0.25f} * float(1 + std::max(0, int(x) - 4)))) << x;
    EXPECT_EQ(image.pixels[10 + x], image.pixels[x]) << x;
    EXPECT_EQ(image.pixels[20 + x], image.pixels[x]) << x;
  }
}

TEST(HdrDecode, ARunOfMoreThan255PixelsIsWrittenInPowersOf256) {
  // 1 + 2 + 1 * 256 pixels.
  const FloatImage image =
      decode(hdr_header(259, 1) + rgbe(Vec3{2}) + std::string("\1\1\1\2", 4) + std::string("\1\1\1\1", 4));
  EXPECT_THAT(image.pixels, testing::Each(Vec3{2}));
  EXPECT_EQ(image.pixels.size(), 259u);
}

TEST(HdrDecode, ExposureIsTakenBack) {
  EXPECT_EQ(decode(hdr_header(1, 1, "EXPOSURE=4\nEXPOSURE= 0.5\n") + rgbe(Vec3{8})).pixels[0], Vec3(4));
}

TEST(HdrDecode, SaysWhatIsBrokenAndAtWhichByte) {
  const std::string pixel = rgbe(Vec3{1}), ten = ten_pixels(), head = hdr_header(10, 1);
  const std::size_t data = head.size();
  const auto at = [&](std::size_t byte, const std::string& why) {
    return fmt::format("broken at byte {}: {}", byte, why);
  };
  EXPECT_EQ(refusal(head + ten.substr(0, 39)), at(data + 39, "the data ends early"));
  EXPECT_EQ(refusal(head + ten + "x"),
            at(data + 40, "expected the end of the file after the last row, found 1 more bytes"));
  EXPECT_EQ(refusal("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + pixel),
            at(11, "expected FORMAT=32-bit_rle_rgbe, found '32-bit_rle_xyze'"));
  EXPECT_EQ(refusal("#?RADIANCE\nEXPOSURE=-1\n\n-Y 1 +X 1\n" + pixel),
            at(11, "expected EXPOSURE with a positive number, found '-1'"));
  EXPECT_EQ(
      refusal("#?RADIANCE\n\n+X 1 -Y 1\n" + pixel),
      at(12, "expected the size as '-Y height +X width' (rows from the top left, 1 to 65536 each), found '+X 1 -Y 1'"));
  EXPECT_THAT(refusal("#?RADIANCE\n\n-Y 0 +X 1\n" + pixel), HasSubstr("expected the size"));
  EXPECT_THAT(refusal("#?RADIANCE\n\n-Y 99999999999 +X 1\n" + pixel), HasSubstr("expected the size"));
  EXPECT_EQ(refusal(head + std::string("\1\1\1\1", 4) + ten), at(data, "a run has no pixel to repeat"));
  EXPECT_EQ(refusal(head + pixel + std::string("\1\1\1\xff", 4)),
            at(data + 4, "a run of 255 pixels goes beyond the row, of which 9 are left"));
  EXPECT_EQ(refusal(head + std::string("\2\2\0\x0b", 4) + ten),
            at(data, "a row says that it has 11 pixels; expected 10"));
  EXPECT_EQ(refusal(head + std::string("\2\2\0\x0a\x8b\1", 6) + ten),
            at(data + 4, "a run of 11 bytes goes beyond the row, of which 10 are left"));
  EXPECT_EQ(refusal(head + std::string("\2\2\0\x0a\0", 5) + ten), at(data + 4, "a run has length 0"));
  EXPECT_EQ(refusal(hdr_header(1, 1000) + pixel),
            at(hdr_header(1, 1000).size(), "4 bytes are left; 1000 rows need more"));
  EXPECT_EQ(refusal("#?RADIANCE\n" + std::string(5000, 'a')), at(11, "a line of the header does not end"));
  EXPECT_EQ(refusal("#?"), at(2, "the data ends early"));
}

TEST(HdrDecode, AnnouncesItsSizeBeforeItTakesMemory) {
  EXPECT_THAT(refusal(hdr_header(65536, 2) + std::string(8, '\0')), HasSubstr("of 65536 x 2 pixels needs 2 MiB"));
  EXPECT_THAT(refusal(hdr_header(65537, 1) + rgbe(Vec3{1})), HasSubstr("expected the size"));
  EXPECT_EQ(decode(hdr_header(1, 1) + rgbe(Vec3{1}), 16).pixels.size(), 1u);
  EXPECT_THROW(decode(hdr_header(1, 1) + rgbe(Vec3{1}), 15), std::length_error);
}

TEST(HdrDecode, ChangedFilesLoadOrAreRefused) {
  const std::string pixels = ten_pixels();
  const std::string good = hdr_header(10, 4) + pixels + run_row(pixels, 5) + pixels.substr(0, 4) +
                           std::string("\1\1\1\4", 4) + pixels.substr(20) + run_row(pixels, 3);
  ASSERT_EQ(refusal(good), "");
  for (std::size_t length = 0; length < good.size(); ++length) EXPECT_NE(refusal(good.substr(0, length)), "") << length;
  int loaded = 0, refused = 0;
  for (int i = 0; i < scaled(2000, 300); ++i) {
    HashRandom random(run_seed() + static_cast<std::uint64_t>(i), 9);
    std::string bytes = good;
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size()));
      if (random.below(4) == 0)
        bytes.erase(at, 1 + random.below(3));
      else
        bytes[at] = static_cast<char>(random.below(256));
    }
    ++(refusal(bytes).empty() ? loaded : refused);
  }
  EXPECT_GT(loaded, 50);
  EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace carousel::scene

// The decoders of environment maps against OpenImageIO's own tool, which prints the pixels that it reads.
#include <string>

#include <gtest/gtest.h>

#include "scene/images/exr_decode.h"
#include "scene/images/hdr_decode.h"
#include "tests/scene/images/picture_files.h"

namespace carousel::scene::float_oracle_test {
namespace {

using FloatOracle = PictureFiles;

TEST_F(FloatOracle, RadianceAndOpenExrHaveThePixelsOfOpenImageIO) {
  tool(
      "--create 24x16 3 --fill:topleft=0.1,0.2,0.9:topright=90,3,1:bottomleft=0,1,0.5:bottomright=6,0.05,1 24x16 "
      "-d half -o half.exr -d float --compression zip -o zip.exr --compression piz -o piz.exr -o a.hdr");
  for (const char* name : {"half.exr", "zip.exr", "piz.exr", "a.hdr"}) {
    const Bytes bytes = file(name);
    MemoryBudget memory(1 << 20);
    const FloatImage image = is_exr(bytes) ? decode_exr(bytes, memory) : decode_hdr(bytes, memory);
    ASSERT_EQ(image.pixels.size(), 24u * 16u) << name;
    // Lines as "Pixel (1, 0): 4.000000000 0.312500000 0.875000000", row by row.
    const Bytes listed = (tool(std::string("--info --dumpdata ") + name), file("tool.txt"));
    const std::string text(listed.begin(), listed.end());
    std::size_t at = 0;
    for (const Vec3& pixel : image.pixels) {
      at = text.find("): ", text.find("Pixel (", at));
      ASSERT_NE(at, text.npos) << name;
      at += 3;
      for (int c = 0; c < 3; ++c) {
        std::size_t length = 0;
        EXPECT_NEAR(pixel[c], std::stod(text.substr(at, 40), &length), 6e-10)
            << name << " at " << &pixel - &image.pixels[0];
        at += length;
      }
    }
  }
}

}  // namespace
}  // namespace carousel::scene::float_oracle_test

#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "tests/scene/images/picture_files.h"
#include "tests/support/random_runs.h"

namespace carousel::scene::damaged_picture_test {
namespace {

using DamagedPicture = PictureFiles;

/// Some bytes changed, most of them near the beginning, where sizes and offsets stand; and perhaps an end missing.
Bytes damaged(Bytes bytes, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  constexpr unsigned char kHard[] = {0, 1, 0x7f, 0x80, 0xff};
  for (std::size_t changes = 1 + below(6); changes > 0; --changes) {
    const std::size_t at = below(4) == 0 ? below(bytes.size()) : below(std::min<std::size_t>(bytes.size(), 128));
    bytes[at] = below(2) == 0 ? kHard[below(5)] : static_cast<unsigned char>(below(256));
  }
  if (below(4) == 0) bytes.resize(1 + below(bytes.size()));
  return bytes;
}

// OpenImageIO may break down over some, which takes the process that reads, and nothing else.
TEST_F(DamagedPicture, IsReadOrRefused) {
  tool(kGradient +
       " -d uint8 -o a.tif --tile 16 16 --compression lzw -o b.tif --scanline --compression rle -o a.tga --compression "
       "none -o b.tga -d float -o a.hdr -o c.tif");
  Bytes dds{'D', 'D', 'S', ' ', 124, 0, 0, 0, 7, 0x10, 0, 0, 8, 0, 0, 0, 8};
  dds.resize(128);
  for (const auto& [at, value] : {std::pair{76, 32}, {80, 4}, {84, 'D'}, {85, 'X'}, {86, 'T'}, {87, '5'}, {109, 0x10}})
    dds[static_cast<std::size_t>(at)] = static_cast<unsigned char>(value);
  for (int i = 0; i < 64; ++i) dds.push_back(static_cast<unsigned char>(i * 37));

  std::mt19937 random(run_seed());
  std::size_t all_read = 0, all_refused = 0;
  for (const std::string name : {"a.tif", "b.tif", "c.tif", "a.tga", "b.tga", "a.hdr", "a.dds"}) {
    const Bytes whole = name == "a.dds" ? dds : file(name);
    ASSERT_EQ(refusal(whole, {name}), "decoded") << name;
    std::size_t read = 0, refused = 0, broke = 0;
    for (int i = scaled(60, 20); i > 0; --i) {
      const std::string text = refusal(damaged(whole, random), {name});
      ++(text == "decoded" ? read : text.find("broke down") != text.npos ? broke : refused);
    }
    EXPECT_EQ(refusal(whole, {name}), "decoded") << name << " after damaged ones";
    std::cout << read + refused + broke << " mutants of " << name << ": " << read << " read, " << refused
              << " refused, " << broke << " took the reading process with them\n";
    all_read += read;
    all_refused += refused;
  }
  EXPECT_GT(all_read, 0u);
  EXPECT_GT(all_refused, 0u);
}

}  // namespace
}  // namespace carousel::scene::damaged_picture_test

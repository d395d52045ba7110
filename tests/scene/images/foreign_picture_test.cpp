#include "scene/images/foreign_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include "scene/images/picture_format.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/scene/images/picture_files.h"

namespace carousel::scene::foreign_picture_test {
namespace {

using testing::HasSubstr;

using ForeignPicture = PictureFiles;

void expect_equal(const Image& image, const Image& expected, const std::string& what) {
  EXPECT_EQ(image.width, expected.width) << what;
  EXPECT_EQ(image.height, expected.height) << what;
  EXPECT_EQ(image.rgba, expected.rgba) << what;
}

TEST_F(ForeignPicture, FormatsWithoutLossHaveTheTexelsOfPng) {
  // A name, and what the tool is told of it.
  const std::vector<std::pair<std::string, std::string>> files = {{"plain.tif", "--compression none"},
                                                                  {"zip.tif", "--compression zip"},
                                                                  {"lzw.tiff", "--compression lzw"},
                                                                  {"tiled.tif", "--tile 16 16"},
                                                                  {"plain.tga", "--compression none"},
                                                                  {"rle.tga", "--compression rle"},
                                                                  {"a.bmp", ""},
                                                                  {"a.ppm", ""},
                                                                  {"a.sgi", ""},
                                                                  {"a.rla", ""},
                                                                  {"a.iff", ""},
                                                                  {"a.dpx", ""},
                                                                  {"a.ico", ""}};
  std::string words = kGradient + " -d uint8 -o a.png";
  for (const auto& [name, told] : files) words += " --scanline " + told + " -o " + name;
  tool(words);
  const Image expected = decode(file("a.png"));
  ASSERT_EQ(expected.width, 24u);
  for (const auto& [name, told] : files) expect_equal(decode(file(name), {name}), expected, name);
}

TEST_F(ForeignPicture, SixteenBitsAreRoundedAsThoseOfPng) {
  tool(kGradient + " -d uint16 -o a.png -o a.tif -o a.dpx");
  const Image expected = decode(file("a.png"));
  for (const char* name : {"a.tif", "a.dpx"}) expect_equal(decode(file(name), {name}), expected, name);
}

TEST_F(ForeignPicture, AlphaIsNotMultiplied) {
  tool(
      "--create 8x8 4 --fill:topleft=1,0.5,0.2,1:topright=1,0.5,0.2,0.2:bottomleft=1,0.5,0.2,0.8:bottomright="
      "1,0.5,0.2,0.5 8x8 -d uint8 --attrib oiio:UnassociatedAlpha 1 -o a.png -o a.tif -o a.tga -o a.iff");
  const Image expected = decode(file("a.png"));
  EXPECT_LT(expected.rgba[7 * 4 + 3], 60);
  for (const char* name : {"a.tif", "a.tga"}) expect_equal(decode(file(name), {name}), expected, name);
}

TEST_F(ForeignPicture, FloatsBecomeSrgbForColoursAndStayForOtherUses) {
  tool("--create 2x1 3 --fill:left=0.5,0.25,2:right=0,0.0625,1 2x1 -d float -o a.tif -o a.hdr -o a.exr");
  const float pixels[] = {0.5f, 0.25f, 2, 0, 0.0625f, 1};
  std::ofstream(folder_ / "a.pfm", std::ios::binary)
      << "PF\n2 1\n-1.0\n"
      << std::string_view(reinterpret_cast<const char*>(pixels), sizeof pixels);
  const auto srgb = [](double c) { return int(255 * (1.055 * std::pow(c, 1 / 2.4) - 0.055) + 0.5); };
  for (const char* name : {"a.tif", "a.hdr", "a.exr", "a.pfm"}) {
    const std::vector<std::uint8_t> colors = decode(file(name), {name, true}).rgba;
    const std::vector<std::uint8_t> others = decode(file(name), {name, false}).rgba;
    ASSERT_EQ(colors.size(), 8u) << name;
    EXPECT_NEAR(colors[0], srgb(0.5), 1) << name;
    EXPECT_NEAR(colors[1], srgb(0.25), 1) << name;
    EXPECT_EQ(colors[2], 255) << name;
    EXPECT_EQ(colors[3], 255) << name;
    EXPECT_NEAR(colors[5], srgb(0.0625), 1) << name;
    EXPECT_NEAR(others[0], 128, 1) << name;
    EXPECT_NEAR(others[1], 64, 1) << name;
    EXPECT_EQ(others[2], 255) << name;
    EXPECT_NEAR(others[5], 16, 1) << name;
  }
}

TEST_F(ForeignPicture, GreyAndOtherFormatsAreRead) {
  tool("--create 8x4 1 --fill:left=0:right=1 8x4 -d uint8 -o grey.png -o grey.tif -o grey.tga -o grey.pgm");
  const Image expected = decode(file("grey.png"));
  for (const char* name : {"grey.tif", "grey.tga", "grey.pgm"})
    expect_equal(decode(file(name), {name}), expected, name);
  tool(kGradient + " -d uint8 -o a.gif -o a.fits --resize 48x32 -o a.jp2");
  for (const char* name : {"a.jp2", "a.gif", "a.fits"}) {
    const Image image = decode(file(name), {name});
    EXPECT_EQ(image.width, name == std::string("a.jp2") ? 48u : 24u) << name;
    EXPECT_NEAR(image.rgba[0], 26, 8) << name;
    EXPECT_NEAR(image.rgba[2], 230, 8) << name;
  }
}

void put(Bytes& out, std::uint32_t value, int bytes, bool big_endian = false) {
  for (int i = 0; i < bytes; ++i)
    out.push_back(static_cast<unsigned char>(value >> 8 * (big_endian ? bytes - 1 - i : i)));
}

/// A DDS of 2 x 1 pixels of 32 bits, by Microsoft's description of DDS_HEADER.
Bytes dds() {
  Bytes out{'D', 'D', 'S', ' '};
  for (const std::uint32_t word : {124u, 0x100fu, 1u, 2u, 8u, 0u, 0u}) put(out, word, 4);
  out.resize(out.size() + 44);
  for (const std::uint32_t word : {32u, 0x41u, 0u, 32u, 0xffu, 0xff00u, 0xff0000u, 0xff000000u}) put(out, word, 4);
  for (const std::uint32_t word : {0x1000u, 0u, 0u, 0u, 0u}) put(out, word, 4);
  out.insert(out.end(), {10, 20, 30, 255, 40, 50, 60, 128});
  return out;
}

/// A PSD of 2 x 1 pixels without layers, by Adobe's description of the format.
Bytes psd() {
  Bytes out{'8', 'B', 'P', 'S'};
  put(out, 1, 2, true);
  out.resize(out.size() + 6);
  put(out, 3, 2, true);
  put(out, 1, 4, true);
  put(out, 2, 4, true);
  put(out, 8, 2, true);
  put(out, 3, 2, true);
  out.resize(out.size() + 12);  // no colour table, resources, layers
  put(out, 0, 2, true);         // no compression
  out.insert(out.end(), {10, 40, 20, 50, 30, 60});
  return out;
}

TEST_F(ForeignPicture, DdsAndPsdAreRead) {
  EXPECT_EQ(decode(dds()).rgba, (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 128}));
  EXPECT_EQ(decode(psd()).rgba, (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 255}));
}

/// A picture of Softimage of 2 x 1 pixels, in one packet of three channels: a run of two that differ.
Bytes softimage() {
  Bytes out;
  put(out, 0x5380f634, 4, true);
  put(out, 0x40600000, 4, true);  // version 3.5
  out.resize(out.size() + 80);
  for (const char c : {'P', 'I', 'C', 'T'}) out.push_back(static_cast<unsigned char>(c));
  put(out, 2, 2, true);
  put(out, 1, 2, true);
  put(out, 0x3f800000, 4, true);
  put(out, 3, 2, true);
  put(out, 0, 2, true);
  out.insert(out.end(), {0, 8, 2, 0xe0, 1, 10, 20, 30, 40, 50, 60});
  return out;
}

/// A Cineon file of 2 x 1 pixels, three channels of ten bits in a word, by Kodak's description of the format.
Bytes cineon() {
  Bytes out;
  for (const std::uint32_t word : {0x802a5fd7u, 2048u, 1024u, 1024u, 0u, 2056u}) put(out, word, 4, true);
  out.insert(out.end(), {'V', '4', '.', '5'});
  out.resize(192);
  put(out, 3, 2, true);  // orientation, channels
  put(out, 0, 2, true);
  for (unsigned channel = 1; channel <= 3; ++channel) {
    out.insert(out.end(), {0, static_cast<unsigned char>(channel), 10, 0});
    for (const std::uint32_t word : {2u, 1u, 0u, 0u, 0x447fc000u, 0x4002f1aau}) put(out, word, 4, true);
  }
  out.resize(680);
  out.insert(out.end(), {0, 5, 0, 0});  // by pixels, in words whose two last bits are empty
  out.resize(2048);
  const auto word = [](std::uint32_t r, std::uint32_t g, std::uint32_t b) { return r << 22 | g << 12 | b << 2; };
  put(out, word(0, 512, 1023), 4, true);
  put(out, word(1023, 100, 4), 4, true);
  return out;
}

/// A grey picture of 2 x 1 pixels in DICOM, explicit and little-endian (part 5 of the standard, section 7.1.2).
Bytes dicom() {
  Bytes out(128);
  const auto element = [](Bytes& to, unsigned group, unsigned number, const std::string& kind, std::string value) {
    if (value.size() % 2 != 0) value += kind == "UI" || kind == "OB" ? '\0' : ' ';
    put(to, group, 2);
    put(to, number, 2);
    to.insert(to.end(), kind.begin(), kind.end());
    if (kind == "OB") put(to, 0, 2);
    put(to, static_cast<std::uint32_t>(value.size()), kind == "OB" ? 4 : 2);
    to.insert(to.end(), value.begin(), value.end());
  };
  const auto number = [](unsigned value) { return std::string{static_cast<char>(value), '\0'}; };
  Bytes meta;
  element(meta, 2, 1, "OB", std::string("\0\1", 2));
  element(meta, 2, 2, "UI", "1.2.840.10008.5.1.4.1.1.7");
  element(meta, 2, 3, "UI", "1.2.3");
  element(meta, 2, 0x10, "UI", "1.2.840.10008.1.2.1");
  for (const char c : {'D', 'I', 'C', 'M'}) out.push_back(static_cast<unsigned char>(c));
  element(out, 2, 0, "UL", number(static_cast<unsigned>(meta.size())) + number(0));
  out.insert(out.end(), meta.begin(), meta.end());
  element(out, 0x28, 2, "US", number(1));
  element(out, 0x28, 4, "CS", "MONOCHROME2");
  for (const auto& [what, value] :
       {std::pair{0x10u, 1u}, {0x11u, 2u}, {0x100u, 8u}, {0x101u, 8u}, {0x102u, 7u}, {0x103u, 0u}})
    element(out, 0x28, what, "US", number(value));
  element(out, 0x7fe0, 0x10, "OB", std::string("\x32\xc8", 2));
  return out;
}

TEST_F(ForeignPicture, FormatsThatTheToolDoesNotWriteAreReadFromTheirDescriptions) {
  EXPECT_EQ(decode(softimage()).rgba, (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 255}));
  EXPECT_EQ(decode(dicom()).rgba, (std::vector<std::uint8_t>{50, 50, 50, 255, 200, 200, 200, 255}));
  const std::vector<std::uint8_t> ten_bits = decode(cineon(), {"", false}).rgba;
  ASSERT_EQ(ten_bits.size(), 8u);
  const double expected[] = {0, 512, 1023, 1023, 1023, 100, 4, 1023};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(ten_bits[i], expected[i] * 255 / 1023, 0.51) << i;
}

TEST_F(ForeignPicture, HeifAvifAndZfileAreRead) {
  tool(kGradient + " -d uint8 -o a.png -o a.heif -o a.avif --ch 0 -d float -o a.zfile");
  const Image expected = decode(file("a.png"));
  for (const char* name : {"a.heif", "a.avif"}) {  // with losses
    const Image image = decode(file(name), {name});
    ASSERT_EQ(image.rgba.size(), expected.rgba.size()) << name;
    for (const std::size_t at : {std::size_t{0}, std::size_t{23}, std::size_t{15 * 24}, std::size_t{16 * 24 - 1}})
      for (std::size_t c = 4 * at; c < 4 * at + 4; ++c) EXPECT_NEAR(image.rgba[c], expected.rgba[c], 32) << name << c;
  }
  const Image depth = decode(file("a.zfile"), {"a.zfile", false});
  ASSERT_EQ(depth.rgba.size(), expected.rgba.size());
  for (std::size_t i = 0; i < depth.rgba.size(); i += 4) EXPECT_NEAR(depth.rgba[i], expected.rgba[i], 1) << i;
}

/// The direct decoders against OpenImageIO's.
TEST_F(ForeignPicture, DirectDecodersGiveTheTexelsOfOpenImageIO) {
  tool(kGradient +
       " -d uint8 -o rgb.png --quality 90 -o a.jpg --quality 40 --attrib jpeg:subsampling 4:2:0 -o sub.jpg "
       "--compression lossless -o rgb.webp -d uint16 -o deep.png --ch 0 -d uint8 -o grey.png -o grey.jpg");
  tool(
      "--create 8x8 4 --fill:topleft=1,0.5,0.2,1:topright=1,0.5,0.2,0.2:bottomleft=1,0.5,0.2,0.8:bottomright="
      "1,0.5,0.2,0.5 8x8 -d uint8 --attrib oiio:UnassociatedAlpha 1 -o rgba.png");
  const std::vector<std::pair<std::string, PictureFormat>> files = {
      {"rgb.png", {"png", "PNG"}},    {"deep.png", {"png", "PNG"}},  {"grey.png", {"png", "PNG"}},
      {"rgba.png", {"png", "PNG"}},   {"a.jpg", {"jpeg", "JPEG"}},   {"sub.jpg", {"jpeg", "JPEG"}},
      {"grey.jpg", {"jpeg", "JPEG"}}, {"rgb.webp", {"webp", "WebP"}}};
  for (const auto& [name, format] : files) {
    const Bytes bytes = file(name);
    MemoryBudget memory(64 << 20);
    expect_equal(decode(bytes), decode_foreign_picture(bytes, format, {}, memory), name);
  }
}

TEST_F(ForeignPicture, BeyondTheMemoryIsRefusedBeforeItIsRead) {
  tool("--create 2000x1000 3 -d uint8 --compression zip -o a.tif");
  EXPECT_EQ(refusal(file("a.tif"), {}, 5 << 20),
            "of 2000 x 1000 pixels needs 14 MiB of memory; 5 of 5 MiB are left (engine.memory_limit_mib)");
  EXPECT_EQ(decode(file("a.tif"), {}, 15 << 20).width, 2000u);
}

TEST_F(ForeignPicture, BrokenOnesAreRefusedWithTheirPlace) {
  tool(kGradient + " -d uint8 -o a.tif");
  Bytes cut = file("a.tif");
  cut.resize(100);
  EXPECT_THAT(refusal(cut), HasSubstr("broken: "));
  GltfBuilder b = GltfBuilder::square();
  const int view = b.view(cut);
  b.push("images", {{"bufferView", view}, {"mimeType", "image/tiff"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  try {
    b.load();
    FAIL() << "a broken picture was read";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.json_path(), "/images/0");
    EXPECT_THAT(error.message(), HasSubstr("the image is broken: "));
  }
}

TEST_F(ForeignPicture, OfGltfAreTexturesLikeOthers) {
  // No bytes of their own begin a TGA without a footer: its type tells it.
  Bytes tga{0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0x20, 3, 2, 1};
  GltfBuilder b = GltfBuilder::square();
  const int view = b.view(tga);
  b.push("images", {{"bufferView", view}, {"mimeType", "image/x-tga"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_EQ(b.load().images.at(0).rgba, (std::vector<std::uint8_t>{1, 2, 3, 255}));
}

TEST(ForeignPictures, WithoutTheModuleAreNamedWithItsPackage) {
  // In a process of its own: this one may have the module at work.
  const pid_t child = fork();
  if (child == 0) {
    setenv("CAROUSEL_MODULES", "/nonexistent", 1);
    MemoryBudget memory(1 << 20);
    try {
      decode_image(dds(), memory);
    } catch (const std::runtime_error& error) {
      const std::string text = error.what();
      const bool named =
          text.starts_with("DDS, neither PNG nor JPEG nor WebP, and the module pictures is not there: /nonexistent") &&
          text.find("carousel-pictures") != text.npos;
      _exit(named ? 0 : 1);
    }
    _exit(2);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(ForeignPictures, FormatsAreToldByBytesThenByEndings) {
  const auto name = [](const Bytes& bytes, const char* file) { return picture_format(bytes, file).name; };
  EXPECT_EQ(name({'I', 'I', '*', 0}, ""), "tiff");
  EXPECT_EQ(name({'I', 'I', '*', 0}, "photo.NEF"), "raw");
  EXPECT_EQ(name({1, 2}, "a/b.TGA"), "targa");
  EXPECT_EQ(name({1, 2}, "tga"), "");
  EXPECT_EQ(name({}, ""), "");
}

}  // namespace
}  // namespace carousel::scene::foreign_picture_test

// Malformed buffers, images and containers, and the files beside a .gltf.
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "core/system/executor.h"
#include "tests/scene/gltf/encode_image.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

TEST(GltfMalformed, BufferViewOutsideItsBuffer) {
  GltfBuilder b = GltfBuilder::square();
  b.json["bufferViews"][0]["byteOffset"] = 40;
  expect_refused(b, "/bufferViews/0", "bytes 40 to 88 lie outside buffer 0, which has 60");
  b.json["bufferViews"][0] = {{"buffer", 0}, {"byteOffset", 9007199254740991.0}, {"byteLength", 9007199254740991.0}};
  expect_refused(b, "/bufferViews/0", "lie outside buffer 0");
}

TEST(GltfMalformed, ImageViewOutsideItsBuffer) {
  GltfBuilder b = GltfBuilder::square();
  const int view = b.push("bufferViews", {{"buffer", 0}, {"byteOffset", 50}, {"byteLength", 1000000}});
  b.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  b.push("textures", {{"source", 0}});
  b.push("materials", {{"normalTexture", {{"index", 0}}}});
  expect_refused(b, "/bufferViews/2", "bytes 50 to 1000050 lie outside buffer 0, which has 60");
}

TEST(GltfMalformed, BufferShorterThanAnnounced) {
  GltfBuilder b = GltfBuilder::square();
  b.json["buffers"] =
      Json::array({{{"byteLength", 60}, {"uri", "data:;base64," + GltfBuilder::base64(std::vector<std::byte>(59))}}});
  expect_refused(b, "/buffers/0/byteLength", "60 bytes are announced, the data has 59");
}

TEST(GltfMalformed, BufferAddresses) {
  const auto refuse = [](const std::string& uri, const std::string& message) {
    GltfBuilder b = GltfBuilder::square();
    b.json["buffers"] = Json::array({{{"byteLength", 60}, {"uri", uri}}});
    expect_refused(b, "/buffers/0/uri", message);
  };
  refuse("http://example.org/a.bin", "http: addresses are not fetched");
  refuse("file:///etc/passwd", "file: addresses are not fetched");
  refuse("C:\\a.bin", "C: addresses are not fetched");
  refuse("/etc/passwd", "absolute paths are refused");
  refuse("%2Fetc/passwd", "absolute paths are refused");
  refuse("a/../../../../b.bin", "more than two folders above");
  refuse("a.bin", "a scene in memory cannot refer to other files");
  refuse("a%00.bin", "expected the path of a file");
  refuse("", "expected the path of a file");
  refuse("data:application/octet-stream,abc", "expected a data: URI in base64");
  refuse("data:;base64,$$$$", "not proper base64");
  GltfBuilder b = GltfBuilder::square();
  b.json["buffers"] = Json::array({{{"byteLength", 60}}});
  expect_refused(b, "/meshes/0/primitives/0/attributes/POSITION",
                 "the data of accessor 0 is not in the file: buffer 0 holds none");
}

TEST(GltfMalformed, GlbContainer) {
  const std::vector<std::byte> good = GltfBuilder::square().glb();
  const auto load = [](const std::vector<std::byte>& bytes) {
    return [&bytes] { load_gltf_from_memory(bytes, "test.glb"); };
  };
  EXPECT_NO_THROW(load(good)());
  const auto change = [&](std::size_t at, std::uint8_t value, const std::string& message) {
    std::vector<std::byte> bad = good;
    bad[at] = static_cast<std::byte>(value);
    expect_scene_error(load(bad), "", message);
  };
  change(4, 1, "GLB container version 1; only version 2 is read");
  change(11, 0x7f, "GLB header gives a length of");
  change(15, 0x7f, "GLB chunk at byte 12 says");
  change(16, 'X', "the first GLB chunk is not JSON");
  std::vector<std::byte> cut(good.begin(), good.begin() + 9);
  expect_scene_error(load(cut), "", "GLB header is cut off");
  for (std::size_t size = 0; size < good.size(); ++size) {
    cut.assign(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(load(cut)(), SceneError) << size;
  }
}

class GltfFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("carousel-gltf-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_ / "model");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::filesystem::path& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  std::filesystem::path folder_;
};

TEST_F(GltfFiles, BuffersAreFoundBesideTheFileAndLittleAbove) {
  GltfBuilder b = GltfBuilder::square();
  const std::string data(reinterpret_cast<const char*>(b.binary.data()), b.binary.size());
  b.json["buffers"] = Json::array({{{"byteLength", b.binary.size()}, {"uri", "my%20data.bin"}}});
  write("model/a.gltf", b.text());
  write("model/my data.bin", data + "more bytes than announced are fine");
  EXPECT_EQ(load_gltf(folder_ / "model/a.gltf").meshes[0].positions.size(), 4u);
  b.json["buffers"][0]["uri"] = "../up.bin";
  write("model/b.gltf", b.text());
  write("up.bin", data);
  EXPECT_NO_THROW(load_gltf(folder_ / "model/b.gltf"));
}

TEST_F(GltfFiles, MissingAndTruncatedBuffersAreNamed) {
  GltfBuilder b = GltfBuilder::square();
  b.json["buffers"] = Json::array({{{"byteLength", b.binary.size()}, {"uri", "gone.bin"}}});
  write("a.gltf", b.text());
  const std::string file = (folder_ / "a.gltf").string();
  expect_scene_error([&] { load_gltf(file); }, "/buffers/0/uri", "'gone.bin': no such file");
  write("gone.bin", "short");
  expect_scene_error([&] { load_gltf(file); }, "/buffers/0/byteLength", "60 bytes are announced, the data has 5");
  try {
    load_gltf(file);
  } catch (const SceneError& e) {
    EXPECT_EQ(e.file(), file);
  }
}

// The pictures of a model are those of a single thread, and its error is that of the first one in the file.
TEST_F(GltfFiles, ImagesAreDecodedAtOnceWithTheSameResult) {
  constexpr int kImages = 24;
  GltfBuilder b = GltfBuilder::square();
  for (int i = 0; i < kImages; ++i) {
    const auto shade = static_cast<unsigned char>(i);
    b.push("images", {{"bufferView", b.view(encode_png(64, 64, 3, std::vector<unsigned char>(64 * 64 * 3, shade)))},
                      {"mimeType", "image/png"},
                      {"name", "shade " + std::to_string(i)}});
    b.push("textures", {{"source", i}});
    b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    b.mesh({{"POSITION", 0}}, 1, {{"material", i}});
  }
  write("a.gltf", b.text());
  const auto executor = make_jthread_executor(4);
  const Scene scene = load_gltf(folder_ / "a.gltf", {}, {}, {}, executor.get());
  ASSERT_EQ(scene.images.size(), std::size_t{kImages});
  for (int i = 0; i < kImages; ++i) {
    const Image& image = scene.images[static_cast<std::size_t>(i)];
    EXPECT_EQ(image.name, "shade " + std::to_string(i));
    ASSERT_EQ(image.rgba.size(), std::size_t{64 * 64 * 4});
    EXPECT_EQ(image.rgba[0], i);
  }
  for (const int broken : {7, 19, 23}) {
    const Json& view = b.json["bufferViews"][b.json["images"][broken]["bufferView"].get<std::size_t>()];
    b.binary[view["byteOffset"].get<std::size_t>() + 1] = std::byte{0};
  }
  write("b.gltf", b.text());
  for (int again = 0; again < 10; ++again)
    expect_scene_error([&] { load_gltf(folder_ / "b.gltf", {}, {}, {}, executor.get()); }, "/images/7", "the image is");
}

TEST_F(GltfFiles, FoldersAndMissingFilesAreRefused) {
  expect_scene_error([&] { load_gltf(folder_); }, "", "no such file");
  expect_scene_error([&] { load_gltf(folder_ / "none.gltf"); }, "", "no such file");
}

}  // namespace
}  // namespace carousel::scene

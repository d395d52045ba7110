// KHR_gaussian_splatting: points that are Gaussians.
#include <string>

#include <gmock/gmock.h>

#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

constexpr const char* kName = "KHR_gaussian_splatting";

Json& primitive(GltfBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}
Json& extension(GltfBuilder& b) {
  return primitive(b)["extensions"][kName];
}
Json& attribute(GltfBuilder& b, const std::string& name) {
  return primitive(b)["attributes"][std::string(kName) + ":" + name];
}

/// Two Gaussians below a node.
GltfBuilder two() {
  GltfBuilder b;
  b.json["extensionsUsed"] = b.json["extensionsRequired"] = {kName};
  const std::string name = std::string(kName) + ":";
  Json attributes{{"POSITION", b.floats({1, 0, 0, 0, 2, 0}, "VEC3", 3)}};
  attributes[name + "ROTATION"] = b.floats({0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, "VEC4", 4);
  attributes[name + "SCALE"] = b.floats({1, 1, 1, 0.5f, 0.25f, 2}, "VEC3", 3);
  attributes[name + "OPACITY"] = b.accessor(b.view(std::vector<std::uint8_t>{255, 51}), 5121, 2, "SCALAR", true);
  attributes[name + "SH_DEGREE_0_COEF_0"] = b.floats({0, 0, 0, 1, -1, -9}, "VEC3", 3);
  b.mesh(attributes, -1,
         {{"mode", 0}, {"extensions", {{kName, {{"kernel", "ellipse"}, {"colorSpace", "lin_rec709_display"}}}}}});
  return b;
}

TEST(GltfGaussians, AreReadWithTheirUnitsAndMovedByTheirNode) {
  GltfBuilder b = two();
  b.json["nodes"][0]["translation"] = {0, 0, 10};
  b.json["nodes"][0]["scale"] = {2, 2, 2};
  std::vector<std::string> warnings;
  const Scene scene = b.load([&](const std::string& w) { warnings.push_back(w); });
  EXPECT_EQ(warnings, std::vector<std::string>{});
  const std::vector<Gaussian>& shapes = scene.gaussians.shapes;
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_FALSE(scene.gaussians.display);
  EXPECT_EQ(shapes[0].mean, Vec3(2, 0, 10));
  EXPECT_EQ(shapes[0].spread, Mat3(2.0f));
  EXPECT_EQ(shapes[0].opacity, 1.0f);
  EXPECT_EQ(shapes[0].color, Vec3(0.5f));
  EXPECT_EQ(shapes[1].mean, Vec3(0, 4, 10));
  EXPECT_NEAR(shapes[1].opacity, 0.2f, 1e-6f);
  EXPECT_NEAR(shapes[1].color.x, 0.78209479f, 1e-6f);
  EXPECT_NEAR(shapes[1].color.y, 0.21790521f, 1e-6f);
  EXPECT_EQ(shapes[1].color.z, 0.0f);
  const Mat3 expected(0, 1, 0, -0.5f, 0, 0, 0, 0, 4);
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(shapes[1].spread[c][r], expected[c][r], 1e-6f) << c << r;
}

TEST(GltfGaussians, OfSeveralNodesAreThereSeveralTimes) {
  GltfBuilder b = two();
  b.node({{"mesh", 0}, {"translation", {5, 0, 0}}});
  extension(b)["colorSpace"] = "srgb_rec709_display";
  const Scene scene = b.load();
  ASSERT_EQ(scene.gaussians.shapes.size(), 4u);
  EXPECT_TRUE(scene.gaussians.display);
  EXPECT_EQ(scene.gaussians.shapes[2].mean, Vec3(6, 0, 0));
}

TEST(GltfGaussians, LeaveHigherHarmonicsOutWithAWarning) {
  GltfBuilder b = two();
  for (int i = 0; i < 3; ++i)
    attribute(b, "SH_DEGREE_1_COEF_" + std::to_string(i)) = b.floats({1, 1, 1, 1, 1, 1}, "VEC3", 3);
  std::vector<std::string> warnings;
  EXPECT_EQ(b.load([&](const std::string& w) { warnings.push_back(w); }).gaussians.shapes.size(), 2u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::HasSubstr("harmonics above degree 0 are left out"));
}

TEST(GltfGaussians, FaultsAreNamed) {
  const std::string at = "/meshes/0/primitives/0";
  const std::string attributes = at + "/attributes";
  const auto refused = [](const auto& damage, const std::string& path, const std::string& message) {
    GltfBuilder b = two();
    damage(b);
    expect_refused(b, path, message);
  };
  refused([](GltfBuilder& b) { extension(b)["kernel"] = "cube"; }, at + "/extensions/KHR_gaussian_splatting/kernel",
          "expected");
  refused([](GltfBuilder& b) { extension(b).erase("colorSpace"); },
          at + "/extensions/KHR_gaussian_splatting/colorSpace", "missing");
  refused([](GltfBuilder& b) { primitive(b)["mode"] = 1; }, at + "/mode", "consists of points; expected 0, found 1");
  for (const std::string name : {"ROTATION", "SCALE", "OPACITY", "SH_DEGREE_0_COEF_0"})
    refused([&](GltfBuilder& b) { primitive(b)["attributes"].erase(std::string(kName) + ":" + name); }, attributes,
            "expected the attribute KHR_gaussian_splatting:" + name);
  refused(
      [](GltfBuilder& b) {
        attribute(b, "SCALE") = b.floats({1, 1, 1, -1, 1, 1}, "VEC3", 3);
      },
      attributes + "/KHR_gaussian_splatting:SCALE", "Gaussian 1 has the scale -1, 1, 1; expected lengths");
  refused(
      [](GltfBuilder& b) {
        attribute(b, "OPACITY") = b.floats({1, 1.5f}, "SCALAR", 1);
      },
      attributes + "/KHR_gaussian_splatting:OPACITY", "Gaussian 1 has the opacity 1.5; expected 0 to 1");
  refused([](GltfBuilder& b) { attribute(b, "OPACITY") = b.floats({1}, "SCALAR", 1); },
          attributes + "/KHR_gaussian_splatting:OPACITY", "has 1 elements, POSITION has 2");
  refused(
      [](GltfBuilder& b) {
        attribute(b, "ROTATION") = b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 4);
      },
      attributes, "Gaussian 1 has no shape");
  refused([](GltfBuilder& b) { b.json["nodes"][0]["scale"] = {1, 0, 1}; }, at, "flattens the Gaussians");
}

}  // namespace
}  // namespace carousel::scene

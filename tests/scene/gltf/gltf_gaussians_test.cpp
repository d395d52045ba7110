// KHR_gaussian_splatting: points that are Gaussians.
#include <cmath>
#include <string>

#include <fmt/format.h>
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
  EXPECT_NEAR(shapes[1].color.z, 0.5f - 9 * 0.28209479f, 1e-6f);
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

/// Adds harmonics of a degree; coefficient k of Gaussian i is 10 * degree + k, plus 100 * i.
void add_degree(GltfBuilder& b, int degree) {
  for (int k = 0; k <= 2 * degree; ++k) {
    const float of = static_cast<float>(10 * degree + k);
    attribute(b, fmt::format("SH_DEGREE_{}_COEF_{}", degree, k)) =
        b.floats({of, of, of, of + 100, of + 100, of + 100}, "VEC3", 3);
  }
}

// A turned node turns the space of the harmonics, a larger one does not.
TEST(GltfGaussians, HaveHarmonicsOfDegree0To3InTheSpaceOfTheirNode) {
  for (int degree = 0; degree <= 3; ++degree) {
    GltfBuilder b = two();
    for (int of = 1; of <= degree; ++of) add_degree(b, of);
    b.json["nodes"][0]["scale"] = {2, 2, 2};
    b.node({{"mesh", 0}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});  // x goes to y
    const GaussianCloud cloud = b.load().gaussians;
    EXPECT_EQ(cloud.degree, degree);
    const std::size_t each = higher_harmonics(degree);
    ASSERT_EQ(cloud.harmonics.size(), 4 * each);
    std::size_t at = each;
    for (int of = 1; of <= degree; ++of)
      for (int k = 0; k <= 2 * of; ++k) EXPECT_EQ(cloud.harmonics[at++], Vec3(static_cast<float>(100 + 10 * of + k)));
    if (degree == 0) continue;
    ASSERT_EQ(cloud.frames.size(), 2u);
    EXPECT_EQ(cloud.shapes[0].frame, 0u);
    EXPECT_EQ(cloud.shapes[3].frame, 1u);
    EXPECT_EQ(cloud.frames[0], DMat3(1.0));
    const DVec3 back = cloud.frames[1] * DVec3(0, 1, 0);
    EXPECT_NEAR(back.x, 1, 1e-6);
    EXPECT_NEAR(back.y, 0, 1e-6);
  }
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
  refused(
      [](GltfBuilder& b) {
        add_degree(b, 1);
        primitive(b)["attributes"].erase(std::string(kName) + ":SH_DEGREE_1_COEF_2");
      },
      attributes,
      "expected the attribute KHR_gaussian_splatting:SH_DEGREE_1_COEF_2, as there are harmonics of degree 1");
  refused([](GltfBuilder& b) { add_degree(b, 2); }, attributes,
          "expected the attribute KHR_gaussian_splatting:SH_DEGREE_1_COEF_0");
  refused(
      [](GltfBuilder& b) {
        attribute(b, "SH_DEGREE_1_COEF_3") = b.floats({1, 1, 1, 1, 1, 1}, "VEC3", 3);
      },
      attributes + "/KHR_gaussian_splatting:SH_DEGREE_1_COEF_3", "expected harmonics of degree 0 to 3");
  refused([](GltfBuilder& b) { add_degree(b, 4); }, attributes + "/KHR_gaussian_splatting:SH_DEGREE_4_COEF_0",
          "expected harmonics of degree 0 to 3");
  refused([](GltfBuilder& b) { b.json["nodes"][0]["scale"] = {1, 0, 1}; }, at, "flattens the Gaussians");
}

}  // namespace
}  // namespace carousel::scene

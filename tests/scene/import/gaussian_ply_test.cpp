// Files of 3D Gaussian splatting: what is read of them, and what is said of damaged ones.
#include "scene/import/gaussian_ply.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/system/error.h"
#include "scene/load_scene.h"
#include "tests/scene/import/gaussian_ply_file.h"

namespace carousel::scene {
namespace {

class GaussianPly : public testing::Test {
 protected:
  ~GaussianPly() override { std::filesystem::remove(file_); }

  void write(const std::string& bytes) const { std::ofstream(file_, std::ios::binary) << bytes; }
  std::string fault_of(const std::string& bytes) const {
    write(bytes);
    try {
      load_gaussian_ply(file_);
    } catch (const SceneError& error) {
      return error.message();
    }
    return "";
  }

  const std::filesystem::path file_ =
      std::filesystem::path(testing::TempDir()) / ("gaussians_" + std::to_string(getpid()) + ".ply");
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST_F(GaussianPly, IsReadWithItsUnits) {
  PlyGaussian one;
  one.x = 1, one.y = 2, one.z = 3;
  one.color[0] = 1, one.color[1] = 0, one.color[2] = -9;
  one.opacity = std::log(3.0f);  // of 0.75
  one.scale[0] = std::log(0.5f), one.scale[1] = std::log(0.25f), one.scale[2] = std::log(2.0f);
  one.rotation[0] = one.rotation[3] = 7;  // a quarter about z, of any length
  write(gaussian_ply({PlyGaussian{}, one}));
  EXPECT_TRUE(is_gaussian_ply(file_));
  const Scene scene = load_gaussian_ply(file_);
  ASSERT_EQ(scene.gaussians.shapes.size(), 2u);
  EXPECT_TRUE(scene.gaussians.display);
  EXPECT_EQ(scene.gaussians.degree, 1);
  const Gaussian& plain = scene.gaussians.shapes[0];
  EXPECT_EQ(plain.opacity, 0.5f);
  EXPECT_EQ(plain.spread, Mat3(1.0f));
  EXPECT_EQ(plain.color, Vec3(0.5f));
  const Gaussian& read = scene.gaussians.shapes[1];
  EXPECT_EQ(read.mean, Vec3(1, 2, 3));
  EXPECT_NEAR(read.opacity, 0.75f, 1e-6f);
  EXPECT_NEAR(read.color.x, 0.78209479f, 1e-6f);
  EXPECT_EQ(read.color.y, 0.5f);
  EXPECT_NEAR(read.color.z, 0.5f - 9 * 0.28209479f, 1e-6f);  // the bound at 0 is that of the whole colour
  const Mat3 expected(0, 0.5f, 0, -0.25f, 0, 0, 0, 0, 2);    // columns: x goes to y, y to -x
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(read.spread[c][r], expected[c][r], 1e-6f) << c << r;
}

// A file has all of red, then all of green, then all of blue.
TEST_F(GaussianPly, HasHarmonicsOfDegree0To3) {
  PlyGaussian one;
  for (int i = 0; i < 45; ++i) one.higher[i] = static_cast<float>(i);
  for (int degree = 0; degree <= 3; ++degree) {
    write(gaussian_ply({PlyGaussian{}, one}, degree));
    const Scene scene = load_gaussian_ply(file_);
    EXPECT_EQ(scene.gaussians.degree, degree);
    const std::size_t each = higher_harmonics(degree);
    ASSERT_EQ(scene.gaussians.harmonics.size(), 2 * each);
    for (std::size_t k = 0; k < each; ++k) {
      EXPECT_EQ(scene.gaussians.harmonics[k], Vec3(0));
      const auto first = static_cast<float>(k), channel = static_cast<float>(each);
      EXPECT_EQ(scene.gaussians.harmonics[each + k], Vec3(first, first + channel, first + 2 * channel));
    }
    SceneConfig config;
    config.file = file_.string();
    config.gaussians.degree = 1;
    const GaussianCloud cloud = load_scene(config, "").gaussians;
    EXPECT_EQ(cloud.degree, std::min(degree, 1));
    ASSERT_EQ(cloud.harmonics.size(), 2 * higher_harmonics(cloud.degree));
    for (std::size_t k = 0; k < higher_harmonics(cloud.degree); ++k)
      EXPECT_EQ(cloud.harmonics[higher_harmonics(cloud.degree) + k], scene.gaussians.harmonics[each + k]);
  }
}

TEST_F(GaussianPly, TakesThePlaceOfAMeshOfPoints) {
  write(gaussian_ply({PlyGaussian{}, PlyGaussian{}, PlyGaussian{}}));
  SceneConfig config;
  config.file = file_.string();
  const Scene spheres = load_scene(config, "");
  EXPECT_EQ(spheres.instances.size(), 3u);
  EXPECT_EQ(spheres.meshes.size(), 1u);
  EXPECT_TRUE(spheres.lights.empty());
  config.gaussians.geometry = GaussiansConfig::Geometry::kTriangles;
  const Scene triangles = load_scene(config, "");
  EXPECT_EQ(triangles.instances.size(), 1u);
  EXPECT_EQ(triangles.unique_triangle_count(), 60u);
  write("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n");
  EXPECT_FALSE(is_gaussian_ply(file_));
}

TEST_F(GaussianPly, HasNoShapeBeyondSinglePrecision) {
  PlyGaussian wide;
  wide.scale[1] = 88;  // three deviations of 1.7e38
  write(gaussian_ply({PlyGaussian{}, wide}));
  SceneConfig config;
  config.file = file_.string();
  try {
    load_scene(config, "");
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.message(), "Gaussian 1 lies or reaches beyond the numbers of single precision");
  }
}

TEST_F(GaussianPly, SaysWhatIsWrong) {
  const std::string good = gaussian_ply({PlyGaussian{}});
  EXPECT_EQ(fault_of(good), "");
  EXPECT_EQ(fault_of(replaced(good, "binary_little_endian", "ascii")),
            "line 2: expected format binary_little_endian 1.0, found \"ascii\"");
  EXPECT_EQ(fault_of(replaced(good, "vertex 1", "vertex one")),
            "line 4: expected a number of Gaussians, found \"one\"");
  EXPECT_EQ(fault_of(replaced(good, "vertex 1", "vertex 0")), "the file has no Gaussians");
  EXPECT_EQ(fault_of(replaced(good, "vertex 1", "vertex 2")),
            "the header announces 2 Gaussians of 104 bytes each, and 104 bytes follow it");
  EXPECT_EQ(fault_of(replaced(good, "vertex 1", "vertex 999999999999999999")),
            "the header announces 999999999999999999 Gaussians of 104 bytes each, and 104 bytes follow it");
  EXPECT_EQ(fault_of(good.substr(0, good.size() - 1)),
            "the header announces 1 Gaussians of 104 bytes each, and 103 bytes follow it");
  EXPECT_EQ(fault_of(replaced(good, "float rot_3", "float rot_4")), "the header has no property float rot_3");
  EXPECT_EQ(fault_of(replaced(good, "float rot_3", "float rot_2")), "line 30: the property rot_2 is there twice");
  EXPECT_EQ(fault_of(replaced(good, "float opacity", "double opacity")),
            "line 23: expected property float opacity, found type \"double\"");
  EXPECT_EQ(fault_of(replaced(good, "float nx", "list uchar nx")),
            "line 8: expected a property of one number, found type \"list\"");
  EXPECT_EQ(fault_of(replaced(good, "f_rest_8", "f_rest_9")),
            "the header has no property float f_rest_8, and it has f_rest_9");
  EXPECT_EQ(fault_of(replaced(good, "f_rest_8", "f_rest_45")),
            "line 22: expected f_rest_0 to f_rest_44, found \"f_rest_45\"");
  EXPECT_EQ(fault_of(replaced(good, "f_rest_8", "other")),
            "the header has 8 properties f_rest_*; expected 0, 9, 24 or 45, as harmonics of degree 0, 1, 2 or 3 have");
  EXPECT_EQ(fault_of(replaced(good, "float f_rest_8", "uchar f_rest_8")),
            "line 22: expected property float f_rest_8, found type \"uchar\"");
  EXPECT_EQ(fault_of(replaced(good, "end_header", "end_heading")), "the header does not end: there is no end_header");
  PlyGaussian bad;
  bad.scale[1] = 200;
  EXPECT_THAT(fault_of(gaussian_ply({PlyGaussian{}, bad})), testing::HasSubstr("Gaussian 1: scale_0 to scale_2 are"));
  bad = {};
  bad.rotation[0] = 0;
  EXPECT_EQ(fault_of(gaussian_ply({bad})), "Gaussian 0: rot_0 to rot_3 are 0, which is no rotation");
  bad = {};
  bad.higher[4] = INFINITY;
  EXPECT_EQ(fault_of(gaussian_ply({bad})), "Gaussian 0: f_rest_4 is inf; expected a finite number");
  bad = {};
  bad.y = NAN;
  EXPECT_EQ(fault_of(gaussian_ply({bad})), "Gaussian 0: y is nan; expected a finite number");
}

}  // namespace
}  // namespace carousel::scene

// Files of 3D Gaussian splatting: what is read of them, and what is said of damaged ones.
#include "scene/import/gaussian_ply.h"

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
  std::vector<std::string> warnings;
  const Scene scene = load_gaussian_ply(file_, [&](const std::string& w) { warnings.push_back(w); });
  ASSERT_EQ(scene.gaussians.shapes.size(), 2u);
  EXPECT_TRUE(scene.gaussians.display);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], testing::HasSubstr("9 coefficients of harmonics above degree 0 are left out"));
  const Gaussian& plain = scene.gaussians.shapes[0];
  EXPECT_EQ(plain.opacity, 0.5f);
  EXPECT_EQ(plain.spread, Mat3(1.0f));
  EXPECT_EQ(plain.color, Vec3(0.5f));
  const Gaussian& read = scene.gaussians.shapes[1];
  EXPECT_EQ(read.mean, Vec3(1, 2, 3));
  EXPECT_NEAR(read.opacity, 0.75f, 1e-6f);
  EXPECT_NEAR(read.color.x, 0.78209479f, 1e-6f);
  EXPECT_EQ(read.color.y, 0.5f);
  EXPECT_EQ(read.color.z, 0.0f);
  const Mat3 expected(0, 0.5f, 0, -0.25f, 0, 0, 0, 0, 2);  // columns: x goes to y, y to -x
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(read.spread[c][r], expected[c][r], 1e-6f) << c << r;
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
  EXPECT_EQ(fault_of(replaced(good, "end_header", "end_heading")), "the header does not end: there is no end_header");
  PlyGaussian bad;
  bad.scale[1] = 200;
  EXPECT_THAT(fault_of(gaussian_ply({PlyGaussian{}, bad})), testing::HasSubstr("Gaussian 1: scale_0 to scale_2 are"));
  bad = {};
  bad.rotation[0] = 0;
  EXPECT_EQ(fault_of(gaussian_ply({bad})), "Gaussian 0: rot_0 to rot_3 are 0, which is no rotation");
  bad = {};
  bad.y = NAN;
  EXPECT_EQ(fault_of(gaussian_ply({bad})), "Gaussian 0: y is nan; expected a finite number");
}

}  // namespace
}  // namespace carousel::scene

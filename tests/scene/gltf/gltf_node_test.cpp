#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/random_runs.h"

namespace carousel::scene {
namespace {

using Json = nlohmann::json;

TEST(GltfNode, MatrixAndTrsGiveTheSameTransform) {
  GltfBuilder b = GltfBuilder::square();
  const double h = std::sqrt(0.5);  // 90 degrees around z
  b.json["nodes"][0].update({{"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 3, 4}}});
  b.node({{"mesh", 0}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1}}});
  const Scene scene = b.load();
  const Affine& trs = scene.instances[0].world_from_model;
  const Affine& matrix = scene.instances[1].world_from_model;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(trs.linear[c][r], matrix.linear[c][r], 1e-6f);
  }
  EXPECT_EQ(trs.translation, Vec3(1, 2, 3));
  EXPECT_EQ(matrix.translation, Vec3(1, 2, 3));
}

TEST(GltfNode, HierarchyIsComposedInDoubleAndRoundedOnce) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  // 10^8 + 0.5 - 10^8: in single precision the half would be lost on the way.
  const int middle = b.push("nodes", {{"translation", {-1e8, 0, 0}}, {"children", {0}}});
  b.node({{"translation", {100000000.5, 0, 0}}, {"children", {middle}}});
  EXPECT_EQ(b.load().instances[0].world_from_model.translation, Vec3(0.5f, 0, 0));
}

// Turned, scaled, mirrored and moved at each of four levels, against the nodes applied to points one after another.
TEST(GltfNode, NestedTransformsComposeToTheirProduct) {
  using Real = long double;
  using Point = std::array<Real, 3>;
  struct Level {
    std::array<double, 4> q;
    std::array<double, 3> s, t;
  };
  const std::array<Level, 4> levels{{{{0.1, -0.5, 0.3, std::sqrt(0.65)}, {2, 0.5, -1}, {1e4, -20, 3}},
                                     {{0.6, 0, 0, 0.8}, {1, 1, 1}, {-9999.5, 20, 5e3}},
                                     {{0, -0.28, 0, 0.96}, {0.1, 3, 1}, {0.25, 0, -7}},
                                     {{0.5, 0.5, 0.5, 0.5}, {-1, -2, 1}, {0, 1, 2}}}};  // innermost last
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  int node = 0;  // the square's
  b.json["nodes"][0].update({{"rotation", levels[3].q}, {"scale", levels[3].s}, {"translation", levels[3].t}});
  for (std::size_t i = 2; i > 0; --i)
    node =
        b.push("nodes",
               {{"rotation", levels[i].q}, {"scale", levels[i].s}, {"translation", levels[i].t}, {"children", {node}}});
  b.node({{"rotation", levels[0].q}, {"scale", levels[0].s}, {"translation", levels[0].t}, {"children", {node}}});
  const Affine m = b.load().instances[0].world_from_model;

  const auto place = [&](Point x) {
    for (std::size_t i = levels.size(); i-- > 0;) {
      const auto& [rotation, s, t] = levels[i];
      const auto& q = rotation;  // Clang 14 captures no structured bindings
      for (std::size_t a = 0; a < 3; ++a) x[a] *= s[a];
      const auto cross = [&](const Point& v) {
        return Point{q[1] * v[2] - q[2] * v[1], q[2] * v[0] - q[0] * v[2], q[0] * v[1] - q[1] * v[0]};
      };
      const Point once = cross(x), twice = cross(once);  // x + 2 w (q x x) + 2 q x (q x x)
      for (std::size_t a = 0; a < 3; ++a) x[a] += 2 * q[3] * once[a] + 2 * twice[a] + t[a];
    }
    return x;
  };
  const Point origin = place({0, 0, 0});
  for (std::size_t row = 0; row < 3; ++row) {
    const int r = static_cast<int>(row);
    EXPECT_LE(std::fabs(m.translation[r] - origin[row]), 0x1p-24L * std::fabs(origin[row]) + 1e-9L);  // one rounding
    for (int c = 0; c < 3; ++c) {
      Point unit{0, 0, 0};
      unit[static_cast<std::size_t>(c)] = 1;
      EXPECT_NEAR(m.linear[c][r], static_cast<double>(place(unit)[row] - origin[row]), 1e-6);
    }
  }
}

TEST(GltfNode, InstancesFollowDepthFirstNodeOrder) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  const auto leaf = [&](double x) { return b.push("nodes", {{"mesh", 0}, {"translation", {x, 0, 0}}}); };
  const int n1 = leaf(1), n2 = leaf(2), n3 = leaf(3);
  const int inner = b.push("nodes", {{"mesh", 0}, {"translation", {10, 0, 0}}, {"children", {n2, n1}}});
  b.node({{"children", {inner, n3}}});
  b.node({{"mesh", 0}, {"translation", {20, 0, 0}}});
  std::vector<float> order;
  for (const Instance& i : b.load().instances) order.push_back(i.world_from_model.translation.x);
  EXPECT_EQ(order, (std::vector<float>{10, 12, 11, 3, 20}));
}

TEST(GltfNode, OneMeshManyInstancesSomeMirrored) {
  GltfBuilder b = GltfBuilder::square();
  b.node({{"mesh", 0}, {"scale", {-1, 2, 1}}});
  const Scene scene = b.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_GT(glm::determinant(scene.instances[0].world_from_model.linear), 0);
  EXPECT_LT(glm::determinant(scene.instances[1].world_from_model.linear), 0);
}

TEST(GltfNode, SingularScaleIsAllowed) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["scale"] = {1, 0, 1};
  EXPECT_EQ(glm::determinant(b.load().instances[0].world_from_model.linear), 0);
}

TEST(GltfNode, WithoutADefaultSceneTheFirstIsShownAndWithoutScenesAllRoots) {
  GltfBuilder b = GltfBuilder::square();
  const int other = b.push("nodes", {{"mesh", 0}, {"translation", {7, 0, 0}}});
  b.push("scenes", {{"nodes", {other}}});
  EXPECT_EQ(b.load().instances.size(), 1u);
  EXPECT_EQ(b.load().instances[0].world_from_model.translation.x, 0);
  b.json["scene"] = 1;
  EXPECT_EQ(b.load().instances[0].world_from_model.translation.x, 7);
  b.json.erase("scene");
  b.json.erase("scenes");
  EXPECT_EQ(b.load().instances.size(), 2u);
}

// Others reported this kind of fault: glTF 1699, tinybvh 92.
TEST(GltfNode, LongChainsOfNodesLoad) {
  GltfBuilder b = GltfBuilder::square();
  b.json["scenes"][0]["nodes"] = Json::array();
  int child = 0;
  const int nodes = scaled(200000);
  for (int i = 0; i < nodes; ++i) child = b.push("nodes", {{"translation", {0, 0, 1}}, {"children", {child}}});
  b.json["scenes"][0]["nodes"].push_back(child);
  EXPECT_EQ(b.load().instances[0].world_from_model.translation.z, static_cast<float>(nodes));
}

TEST(GltfNode, GpuInstancingIsExpandedInPlace) {
  GltfBuilder b = GltfBuilder::square();
  const int t = b.floats({1, 0, 0, 2, 0, 0}, "VEC3", 3);
  const int r = b.accessor(b.view(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}), 5122, 2, "VEC4", true);
  const int s = b.floats({1, 1, 1, -2, 3, 1}, "VEC3", 3);
  b.json["nodes"][0]["translation"] = {0, 5, 0};
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", t}, {"ROTATION", r}, {"SCALE", s}};
  b.node({{"mesh", 0}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.instances.size(), 3u);
  EXPECT_EQ(scene.instances[0].world_from_model.translation, Vec3(1, 5, 0));
  EXPECT_EQ(scene.instances[1].world_from_model.translation, Vec3(2, 5, 0));
  const Mat3& m = scene.instances[1].world_from_model.linear;  // half a turn around z, then scale
  EXPECT_EQ(m[0], Vec3(2, 0, 0));
  EXPECT_EQ(m[1], Vec3(0, -3, 0));
  EXPECT_EQ(scene.instances[2].world_from_model.translation, Vec3(0, 0, 0));
}

TEST(GltfNode, RefusesGpuInstancingOfDifferentLengths) {
  GltfBuilder b = GltfBuilder::square();
  const int t = b.floats({1, 0, 0, 2, 0, 0}, "VEC3", 3), s = b.floats({1, 1, 1}, "VEC3", 3);
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", t}, {"SCALE", s}};
  expect_refused(b, "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/TRANSLATION",
                 "accessor 2 has 2 elements, other attributes have 1");
}

TEST(GltfNode, RefusesGpuInstancingOfHugeCount) {
  GltfBuilder b = GltfBuilder::square();
  const int t = b.accessor(-1, 5126, 4000000000u, "VEC3");
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", t}};
  expect_refused(b, "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes", "asks for 4000000000 elements");
}

TEST(GltfNode, RefusesGpuInstancingWithZeroQuaternion) {
  GltfBuilder b = GltfBuilder::square();
  const int r = b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4", 4);
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", r}};
  expect_refused(b, "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes/ROTATION",
                 "the quaternion of instance 1 has length zero");
}

TEST(GltfNode, RefusesZeroQuaternion) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
  expect_refused(b, "/nodes/0/rotation", "length zero");
}

TEST(GltfNode, RefusesProjectiveMatrix) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1};
  expect_refused(b, "/nodes/0/matrix", "not an affine transform");
}

TEST(GltfNode, RefusesTransformsThatOverflow) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["scale"] = {1e38, 1, 1};
  b.json["scenes"][0]["nodes"] = Json::array();
  b.node({{"scale", {1e38, 1, 1}}, {"children", {0}}});
  expect_refused(b, "/nodes/0", "too large for single precision");
}

TEST(GltfCamera, PerspectiveTakesPoseFromTheNodeWithoutItsScale) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras", {{"type", "perspective"},
                     {"name", "main"},
                     {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 1.5}}}});
  const double h = std::sqrt(0.5);
  b.node({{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}, {"scale", {-2, 2, 2}}});
  const Camera c = b.load().cameras.at(0);
  EXPECT_EQ(c.projection, Camera::Projection::kPerspective);
  EXPECT_EQ(c.position, Vec3(1, 2, 3));
  EXPECT_NEAR(glm::distance(c.back, Vec3(1, 0, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(c.up, Vec3(0, 1, 0)), 0, 1e-6);
  EXPECT_NEAR(glm::dot(glm::cross(c.right, c.up), c.back), 1, 1e-6);  // right-handed though mirrored
  EXPECT_FLOAT_EQ(c.yfov, 0.5f);
  EXPECT_FLOAT_EQ(c.aspect_ratio.value(), 1.5f);
  EXPECT_EQ(c.name, "main");
}

TEST(GltfCamera, OrthographicKeepsItsMagnification) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras",
         {{"type", "orthographic"}, {"orthographic", {{"xmag", 2}, {"ymag", 3}, {"znear", 0}, {"zfar", 10}}}});
  b.node({{"camera", 0}});
  const Camera c = b.load().cameras.at(0);
  EXPECT_EQ(c.projection, Camera::Projection::kOrthographic);
  EXPECT_EQ(c.xmag, 2);
  EXPECT_EQ(c.ymag, 3);
}

TEST(GltfCamera, WithoutOneACameraIsFittedToTheBounds) {
  GltfBuilder b = GltfBuilder::square();
  b.json["nodes"][0]["translation"] = {1e6, 0, 0};
  const Scene scene = b.load();
  const Camera c = scene.cameras.at(0);
  for (const Vec3& p : scene.meshes[0].positions) {
    const Vec3 d = p + Vec3(1e6, 0, 0) - c.position;
    const float depth = -glm::dot(d, c.back);
    EXPECT_GT(depth, 0);
    EXPECT_LT(std::abs(glm::dot(d, c.up)), depth * std::tan(0.5f * c.yfov));
    EXPECT_LT(std::abs(glm::dot(d, c.right)), depth * std::tan(0.5f * c.yfov));
  }
}

TEST(GltfCamera, RefusesCamerasWithoutTheirDetails) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras", {{"type", "perspective"}});
  b.node({{"camera", 0}});
  expect_refused(b, "/cameras/0/perspective", "missing");
}

TEST(GltfCamera, RefusesCamerasFlattenedByTheirNode) {
  GltfBuilder b = GltfBuilder::square();
  b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}});
  const int node = b.node({{"camera", 0}, {"scale", {1, 1, 0}}});
  expect_refused(b, "/nodes/" + std::to_string(node), "no view direction");
}

TEST(GltfLight, PointSpotAndDirectional) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] =
      Json::array({{{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}, {"range", 4}},
                   {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
                   {{"type", "directional"}, {"intensity", 3}}});
  const double h = std::sqrt(0.5);
  const auto light = [](int i) { return Json{{"KHR_lights_punctual", {{"light", i}}}}; };
  b.node({{"translation", {1, 2, 3}}, {"extensions", light(0)}});
  b.node({{"rotation", {-h, 0, 0, h}}, {"extensions", light(1)}});  // down
  b.node({{"extensions", light(2)}});
  const Scene scene = b.load();
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_EQ(scene.lights[0].intensity, Vec3(10, 5, 0));
  EXPECT_EQ(scene.lights[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(scene.lights[0].range, 4);
  EXPECT_EQ(scene.lights[1].kind, PunctualLight::Kind::kSpot);
  EXPECT_NEAR(glm::distance(scene.lights[1].direction, Vec3(0, -1, 0)), 0, 1e-6);
  EXPECT_FLOAT_EQ(scene.lights[1].outer_cone_cos, std::cos(0.2f));
  EXPECT_EQ(scene.lights[2].kind, PunctualLight::Kind::kDirectional);
  EXPECT_EQ(scene.lights[2].intensity, Vec3(3));
  EXPECT_EQ(scene.lights[2].direction, Vec3(0, 0, -1));
}

TEST(GltfLight, RefusesSpotWithoutConesAndUnknownKinds) {
  GltfBuilder b = GltfBuilder::square();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "spot"}}});
  expect_refused(b, "/extensions/KHR_lights_punctual/lights/0/spot", "missing");
  b.json["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "area";
  expect_refused(b, "/extensions/KHR_lights_punctual/lights/0/type",
                 "expected one of directional point spot, found \"area\"");
}

}  // namespace
}  // namespace carousel::scene

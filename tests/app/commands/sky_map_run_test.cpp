// Environment maps (scene.sky.file), from the files of a user to the files of a run.
#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/types/vec.h"
#include "shading/camera/image_file.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"
#include "tests/support/hdr_file.h"
#include "tests/support/random_runs.h"
#include "tests/support/read_exr.h"

namespace carousel::sky_map_run_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

constexpr double kPi = 3.14159265358979323846;

/// A box of half size 1, or with `floor` one that stands on a large floor; white, without reflection.
std::string white_box(bool floor) {
  scene::GltfBuilder b;
  std::vector<float> positions;
  std::vector<std::uint16_t> indices;
  const auto quad = [&](const Vec3& centre, const Vec3& right, const Vec3& up) {
    const auto first = static_cast<std::uint16_t>(positions.size() / 3);
    for (const Vec3& p : {centre - right - up, centre + right - up, centre + right + up, centre - right + up})
      positions.insert(positions.end(), {p.x, p.y, p.z});
    for (const int i : {0, 1, 2, 0, 2, 3}) indices.push_back(static_cast<std::uint16_t>(first + i));
  };
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  for (const auto& [n, u, v] : {std::array{x, y, z}, {-x, z, y}, {y, z, x}, {-y, x, z}, {z, x, y}, {-z, y, x}})
    quad(n, u, v);
  if (floor) quad({0, -1, 0}, 40.0f * z, 40.0f * x);
  const int at = b.floats(positions, "VEC3", 3);
  const int order = b.accessor(b.view(indices), 5123, indices.size(), "SCALAR");
  b.push("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                       {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}});
  b.json["extensionsUsed"] = {"KHR_materials_specular"};
  b.mesh({{"POSITION", at}}, order, {{"material", 0}});
  return b.text();
}

/// Radiance from a direction.
using Sky = std::function<Vec3(const DVec3&)>;

/// A map of the sky, turned so that it is right with scene.sky.rotation `degrees`.
void bake(const std::filesystem::path& path, const Sky& sky, int width, double degrees) {
  std::vector<float> rgb;
  const int height = width / 2;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // The middle of the picture is -Z, to its right is +X. Turning about +Y moves -Z towards -X.
      const double polar = kPi * (y + 0.5) / height;
      const double around = 2 * kPi * ((x + 0.5) / width - 0.5) - degrees * kPi / 180;
      const Vec3 color =
          sky({std::sin(polar) * std::sin(around), std::cos(polar), -std::sin(polar) * std::cos(around)});
      rgb.insert(rgb.end(), {color.x, color.y, color.z});
    }
  shading::write_exr(path, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), rgb);
}

/// Irradiance over pi on a plane of this normal, by quadrature over the sphere: what a white surface sends out.
Vec3 white_radiance(const Sky& sky, const DVec3& normal) {
  constexpr int kRows = 1000;
  DVec3 sum{0};
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < 2 * kRows; ++c) {
      const double polar = kPi * (r + 0.5) / kRows, around = kPi * (c + 0.5) / kRows;
      const DVec3 w{std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)};
      sum += DVec3(sky(w)) * (std::max(0.0, glm::dot(w, normal)) * std::sin(polar) * (kPi / kRows) * (kPi / kRows));
    }
  return Vec3(sum / kPi);
}

/// Horizon and zenith of two colours, and a sun of 8 degrees across that goes up and down smoothly at its edge.
Vec3 evening(const DVec3& w) {
  const DVec3 sun = glm::normalize(DVec3{0.7, 0.5, 0.4});
  const double up = 0.5 + 0.5 * w.y, away = std::acos(std::clamp(glm::dot(w, sun), -1.0, 1.0)) * 180 / kPi;
  const double glow = 60 * std::clamp((6 - away) / 4, 0.0, 1.0);
  return Vec3(DVec3{0.9 * (1 - up) + glow, 0.4 + 0.7 * glow, 0.8 * up + 0.3 * glow});
}

class SkyMapRun : public testing::Test {
 protected:
  Json run(const std::string& config, std::vector<std::string> sets, const std::string& out = "out") {
    std::vector<std::string> arguments{"run", config, "--out", out, "--quiet", "--force"};
    add_sets(arguments, sets);
    const Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err << testing::PrintToString(sets);
    return outcome.status == 0 ? Json::parse(program_.read(out + "/report.json")) : Json();
  }
  ExrPicture picture(const std::string& out = "out") { return read_exr(program_.folder() / out / "image.exr"); }

  /// The camera looks straight on one face of a box, so near that it sees nothing else.
  static std::string facing(const DVec3& n) {
    const DVec3 eye = 1.3 * n;
    return fmt::format("camera={{eye: [{}, {}, {}], target: [0, 0, 0], up: [{}, {}, {}], field_of_view: 60}}", eye.x,
                       eye.y, eye.z, n.y != 0 ? 1 : 0, n.y != 0 ? 0 : 1, 0);
  }
  static DVec3 mean(const ExrPicture& p) {
    DVec3 sum{0};
    for (std::size_t i = 0; i < p.rgb.size(); i += 3) sum += DVec3{p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]};
    return sum / (static_cast<double>(p.rgb.size()) / 3);
  }

  Program program_;
};

// A map that is baked from a closed form lights each face of a box as quadrature over that form says: by shadow rays
// alone (a path has one surface), by bounce rays alone, and by both, which share the light.
TEST_F(SkyMapRun, ABakedSkyLightsEachFaceAsItsClosedForm) {
  program_.write("box.gltf", white_box(false));
  bake(program_.folder() / "evening.exr", evening, 512, 75);
  program_.write("a.yaml",
                 "scene: {file: box.gltf, sky: {file: evening.exr, rotation: 75}}\n"
                 "image: {width: 24, height: 24, samples: 64, max_depth: 2}\n");
  for (const DVec3& n : some(std::vector<DVec3>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}, 2)) {
    const Vec3 expected = white_radiance(evening, n);
    for (const auto& [way, bound] : std::vector<std::pair<std::string, double>>{
             {"image.max_depth=1", 0.02},
             {"image.max_depth=2", 0.02},
             {"shading.effects=[environment_map, bounce_rays, specular]", 0.1}}) {  // the sun is hit by few
      run("a.yaml", {facing(n), way});
      const DVec3 found = mean(picture());
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[c], expected[c], bound * double{expected[c]}) << way << " " << n.x << n.y << n.z << " " << c;
    }
  }
}

TEST_F(SkyMapRun, RaysOfTheCameraSeeTheMapItself) {
  program_.write("box.gltf", white_box(false));
  const Sky ramp = [](const DVec3& w) { return Vec3(DVec3{2 + w.x, 2 + w.y, 2 + w.z}); };
  bake(program_.folder() / "ramp.exr", ramp, 512, -30);
  program_.write("a.yaml",
                 "scene: {file: box.gltf, sky: {file: ramp.exr, rotation: -30, strength: 2}}\n"
                 "image: {width: 4, height: 4, samples: 16}\n");
  for (const DVec3& to : {DVec3{1, 0, 0}, {0, 1, 0.01}, {0, 0, -1}, {-0.6, -0.8, 0}}) {
    const DVec3 eye = 5.0 * to;
    run("a.yaml", {fmt::format("camera={{eye: [{}, {}, {}], target: [{}, {}, {}], field_of_view: 1}}", eye.x, eye.y,
                               eye.z, 2 * eye.x, 2 * eye.y, 2 * eye.z)});
    const DVec3 found = mean(picture()), expected = 2.0 * DVec3(ramp(glm::normalize(to)));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 0.02) << to.x << " " << to.y << " " << to.z;
  }
}

// A white world: a scene that absorbs nothing below a map of radiance 1 looks like the map. Every estimator has to
// agree: a density or a weight that is wrong makes it brighter or darker.
TEST_F(SkyMapRun, AWhiteSceneVanishesInAWhiteMap) {
  program_.write("scene.gltf", white_box(true));
  for (const int width : {1, 2, 64}) {
    program_.write("white.hdr", hdr_file(width, std::max(1, width / 2), [](int, int) { return Vec3{1}; }));
    for (const char* size : {"width: 24, height: 16, samples: 64", "width: 48, height: 40, samples: 16"}) {
      program_.write("a.yaml", fmt::format("scene: {{file: scene.gltf, sky: {{file: white.hdr}}}}\n"
                                           "image: {{{}, max_depth: 24}}\n"
                                           "camera: {{eye: [3, 2, 5], target: [0, 0, 0], field_of_view: 50}}\n",
                                           size));
      run("a.yaml", {});
      const ExrPicture p = picture();
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(p)[c], 1, 0.01) << size << " " << width;
      EXPECT_EQ(p.rgb[0], 1.0f) << "the map itself, in the corner";
    }
  }
}

TEST_F(SkyMapRun, GivesTheSamePictureOnEveryMachine) {
  bake(program_.folder() / "evening.exr", evening, 64, 0);
  for (const char* image : {"width: 20, height: 12, samples: 4", "width: 33, height: 25, samples: 1"}) {
    program_.write("a.yaml", fmt::format("scene: {{builtin: spheres, triangles: 2000, sky: {{file: evening.exr}}}}\n"
                                         "image: {{{}, max_depth: 4}}\ntopology: {{resources: 4}}\n"
                                         "verify: reference\nengine: {{what_if: false}}\n",
                                         image));
    const Json base = run("a.yaml", {"engine.threads=1"});
    ASSERT_FALSE(base.is_null());
    EXPECT_EQ(base["digest"]["image"].get<std::string>().empty(), false);
    for (const std::vector<std::string>& sets : some(
             std::vector<std::vector<std::string>>{
                 {"engine.threads=3"},
                 {"topology.resources=1"},
                 {"topology.shape=point_to_point", "engine.threads=2"},
                 {"engine.kind=cycle"},
                 {"engine.kind=cycle", "engine.threads=2", "topology.shape=bidirectional"},
                 {"engine.kind=cycle", "topology.shape=independent"},
                 {"engine.kind=cycle", "memory.sky_map=memory", "memory.path_state=memory"},
                 {"engine.kind=cycle", "memory.sky_map=memory", "memory.line_bytes=32", "shading.lanes=4"},
                 {"engine.kind=cycle", "shading.effects=all"},
                 {"engine.simd=scalar"}},
             3)) {
      EXPECT_EQ(run("a.yaml", sets)["digest"], base["digest"]) << testing::PrintToString(sets);
    }
    EXPECT_NE(run("a.yaml", {"scene.sky.rotation=90"})["digest"]["image"], base["digest"]["image"]);
  }
}

TEST_F(SkyMapRun, IsAnEffectThatIsProvedAndCharged) {
  program_.write("box.gltf", white_box(true));
  program_.write("a.hdr", hdr_file(16, 8, [](int x, int y) { return Vec3{float(x), float(y), 1}; }));
  program_.write("a.yaml",
                 "scene: {file: box.gltf, sky: {file: a.hdr}}\nengine: {kind: cycle, what_if: false}\n"
                 "image: {width: 16, height: 12, samples: 1}\ntopology: {resources: 2}\n");
  const Json r = run("a.yaml", {"verify=effects"});
  EXPECT_EQ(r["shading"]["proof"]["same_image"], true);
  EXPECT_EQ(r["shading"]["proof"]["same_hits"], true);
  const auto effect = [](const Json& report, const char* name) {
    for (const Json& row : report["shading"]["effects"])
      if (row["name"] == name) return row;
    return Json();
  };
  EXPECT_EQ(effect(r, "environment_map")["on"], true);
  EXPECT_EQ(effect(r, "environment_map")["why"], "the map a.hdr of 16 x 8");
  EXPECT_EQ(effect(r, "environment_map")["cost"]["texture_reads"], 1);
  EXPECT_EQ(effect(r, "sky")["on"], false);
  // A lookup for each hit that draws light, and for each ray that leaves the scene; none for shadow rays.
  const std::uint64_t lookups = r["shading"]["lookups"];
  const Json& by_kind = r["rays"]["by_kind"];
  EXPECT_EQ(lookups, by_kind["camera"].get<std::uint64_t>() + by_kind["bounce"].get<std::uint64_t>());
  EXPECT_GT(run("a.yaml", {"shading.cycles_per_lookup=200"})["engine"]["cycles"], r["engine"]["cycles"]);

  const Json without = run("a.yaml", {"shading.effects=[bounce_rays]"});
  EXPECT_EQ(effect(without, "environment_map")["on"], false);
  EXPECT_EQ(without["shading"]["lookups"], 0);
  for (const float value : read_exr(program_.folder() / "out/image.exr").rgb) EXPECT_EQ(value, 0.0f);

  program_.write("a.hdr", hdr_file(16, 8, [](int, int) { return Vec3{0}; }));
  const Json black = run("a.yaml", {});
  EXPECT_EQ(effect(black, "environment_map")["why"], "the map a.hdr is black");
  EXPECT_EQ(black["rays"]["by_kind"]["shadow"], 0);
}

TEST_F(SkyMapRun, BytesOfTheMapComeFromMemory) {
  program_.write("box.gltf", white_box(true));
  program_.write("a.hdr", hdr_file(128, 64, [](int x, int y) { return Vec3{float(x), float(y), 1}; }));
  program_.write("a.yaml",
                 "scene: {file: box.gltf, sky: {file: a.hdr}}\nengine: {kind: cycle, what_if: false}\n"
                 "image: {width: 16, height: 12, samples: 1}\ntopology: {resources: 2}\nmemory: {l2_kib: 8}\n");
  const Json free = run("a.yaml", {}), memory = run("a.yaml", {"memory.sky_map=memory"});
  EXPECT_EQ(memory["digest"], free["digest"]);
  EXPECT_FALSE(free["memory"].contains("ray_data"));
  EXPECT_GT(memory["engine"]["cycles"], free["engine"]["cycles"]);
  EXPECT_GT(memory["memory"]["dram_bytes"], free["memory"]["dram_bytes"]);
  const std::uint64_t read = memory["memory"]["ray_data"]["sky_read"], rays = memory["shading"]["lookups"];
  // Four texels of 16 bytes a lookup, and blocks of 64: two for a ray that leaves the scene, and of a search in 64 rows
  // and one in 128 columns at least two and at most nine.
  EXPECT_GE(read, rays * (64 + 128) - rays / 4 * 64);
  EXPECT_LE(read, rays * (64 + 9 * 64));
  EXPECT_EQ(memory["memory"]["ray_data"]["states_read"], 0);
}

TEST_F(SkyMapRun, WhatARunWritesRunsAgainFromAnotherFolder) {
  program_.write("a.hdr", hdr_file(4, 2, [](int x, int) { return Vec3{float(x)}; }));
  program_.write("a.yaml", "scene: {builtin: cornell, sky: {file: a.hdr}}\nimage: {width: 8, height: 8, samples: 1}\n");
  const Json first = run("a.yaml", {}, "one");
  const Json again = run("one/config.resolved.yaml", {}, "two/three");
  EXPECT_EQ(first["digest"], again["digest"]);
}

TEST_F(SkyMapRun, InspectTellsTheMap) {
  program_.write("a.hdr", hdr_file(16, 8, [](int x, int y) { return Vec3{x == 3 && y == 3 ? 512.0f : 0.0f}; }));
  const Outcome table = program_.run({"inspect", "builtin:terrain", "--set", "scene.sky={file: a.hdr}"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("sky          a.hdr: 16 x 8, mean radiance 6.12 6.12 6.12, brightest luminance 512\n"
                                   "             83.6 % of its light comes from the brightest 1 % of the sphere\n"));
  const Json json =
      Json::parse(program_.run({"inspect", "builtin:terrain", "--json", "--set", "scene.sky={file: a.hdr}"}).out);
  EXPECT_EQ(json["scene"]["sky_map"]["width"], 16);
  EXPECT_NEAR(json["scene"]["sky_map"]["brightest_percent_share"].get<double>(), 0.836, 1e-3);
  EXPECT_FALSE(Json::parse(program_.run({"inspect", "builtin:terrain", "--json"}).out)["scene"].contains("sky_map"));
}

TEST_F(SkyMapRun, RefusalsNameKeyPlaceAndFile) {
  program_.write("a.yaml", "scene:\n  builtin: cornell\n  sky: {file: none.hdr}\nimage: {width: 4, height: 4}\n");
  Outcome outcome = program_.run({"run", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("a.yaml:3:15: scene.sky.file: expected an environment map (.hdr or .exr), found "
                                     "'none.hdr', which is not there; looked in"));
  program_.write("none.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\nabcde");
  outcome = program_.run({"run", "a.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("none.hdr: broken at byte 50: the data ends early"));
  program_.write("none.hdr", hdr_file(2, 1, [](int, int) { return Vec3{1}; }));
  EXPECT_EQ(program_.run({"run", "a.yaml", "--set", "scene.sky.rotation=400"}).status, 2);
  outcome = program_.run({"run", "a.yaml", "--strict", "--set", "scene.sky.color=[1, 0, 0]"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("since the sky is a map (scene.sky.file)"));
}

}  // namespace
}  // namespace carousel::sky_map_run_test

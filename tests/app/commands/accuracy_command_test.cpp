#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/accuracy/unit_cost.h"
#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::accuracy_command_test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

// Instances, so that transforms are compared as well; with a seed whose rays call for exact volumes.
constexpr const char* kConfig =
    "scene: {builtin: instances, instances: 20}\nimage: {width: 24, height: 24, samples: 1, max_depth: 3, seed: 2}\n"
    "topology: {resources: 2}\nrays: {slots_per_resource: 64}\n";

const Json& level(const Json& report, const std::string& triangle, const std::string& box,
                  const std::string& transform) {
  for (const Json& row : report.at("levels"))
    if (row.at("triangle") == triangle && row.at("box") == box && row.at("transform") == transform) return row;
  throw std::runtime_error("no row " + triangle + " " + box + " " + transform);
}

std::uint64_t wrong(const Json& errors) {
  return errors.at("missed").get<std::uint64_t>() + errors.at("extra").get<std::uint64_t>() +
         errors.at("other").get<std::uint64_t>();
}

void finds_the_leaks_of_the_fast_level_and_none_of_the_watertight_ones(const Json& report) {
  EXPECT_GT(level(report, "fast", "plain", "two_step").at("leaks"), 0);
  for (const auto& [triangle, box] :
       {std::pair{"watertight", "conservative"}, {"double", "double"}, {"exact", "double"}}) {
    const Json& row = level(report, triangle, box, "two_step");
    EXPECT_EQ(row.at("leaks"), 0) << triangle;
    EXPECT_EQ(row.at("hard").at("edges").at("missed"), 0) << triangle;
  }
}

void exact_tests_agree_with_the_reference_where_no_transform_rounds(const Json& report) {
  const Json& row = level(report, "exact", "double", "two_step");
  for (const char* name : {"edges", "slivers"}) EXPECT_EQ(wrong(row.at("hard").at(name)), 0u) << name;
  EXPECT_GT(wrong(level(report, "fast", "plain", "two_step").at("hard").at("slivers")), 0u);
}

void one_inverse_matrix_loses_far_meshes(const Json& report) {
  const auto far = [&](const char* transform) {
    return level(report, "watertight", "conservative", transform).at("hard").at("far mesh");
  };
  EXPECT_GT(far("inverse_matrix").at("missed").get<int>(), 10 * far("two_step").at("missed").get<int>());
}

void a_bounded_spawn_offset_never_hits_its_own_triangle(const Json& report) {
  for (const Json& row : report.at("spawn")) {
    EXPECT_GT(row.at("bounces"), 100);
    if (row.at("spawn") == "bound") {
      EXPECT_EQ(row.at("self_hits").get<int>() + row.at("far_self_hits").get<int>(), 0);
    }
    if (row.at("spawn") == "epsilon") {
      EXPECT_GT(row.at("far_self_hits"), 0);
    }
  }
}

void times_modelled_cycles_and_pictures_are_there(const Json& report) {
  for (const Json& row : report.at("levels")) {
    EXPECT_GT(row.at("ns_per_ray").at("least"), 0);
    EXPECT_LE(row.at("ns_per_ray").at("least"), row.at("ns_per_ray").at("most"));
    EXPECT_GT(row.at("modelled_cycles_per_ray"), 0);
    EXPECT_EQ(row.at("picture").at("pixels"), 24 * 24);
    const Json& range = row.at("tester_limited_cycles_range");
    EXPECT_LT(range.at("least"), range.at("most")) << "four seeds of the picture take the same cycles";
    EXPECT_LE(range.at("least"), row.at("tester_limited_cycles_per_ray"));
    EXPECT_GE(range.at("most"), row.at("tester_limited_cycles_per_ray"));
    for (const char* clock : {"host", "hardware"}) {
      const Json& over = row.at("over_cheapest").at(clock);
      EXPECT_LE(over.at("low"), over.at("ratio"));
      EXPECT_LE(over.at("ratio"), over.at("high"));
    }
  }
  // The machine waits for its shaders; its testers work longer all the same.
  EXPECT_GT(
      level(report, "double", "double", "two_step").at("modelled_tester_cycles_per_ray").get<double>(),
      2 * level(report, "watertight", "conservative", "two_step").at("modelled_tester_cycles_per_ray").get<double>());
  // Where the testers limit, four passes a test cost what they take.
  const auto limited = [&](const char* triangle, const char* box) {
    return level(report, triangle, box, "two_step").at("tester_limited_cycles_per_ray").get<double>();
  };
  EXPECT_GT(limited("double", "double"), 2 * limited("watertight", "conservative"));
  EXPECT_GT(limited("exact", "double"), 0.95 * limited("double", "double"));  // equal tests, in another order
  EXPECT_GE(report.at("sampling").at("rows").size(), 6u);
  EXPECT_NEAR(report.at("sampling").at("slope").get<double>(), -0.5, 0.2);
}

void areas_and_energies_follow_the_levels(const Json& report) {
  const Json& base = level(report, "watertight", "conservative", "two_step");
  EXPECT_EQ(base.at("unit_area_over_default"), 1);
  EXPECT_GT(base.at("unit_area_mm2"), 0);
  const Json& wide = level(report, "double", "double", "two_step");
  // By hand, in mm^2: four box units of 0.0727 or, in 64 bits, 0.1166; a triangle unit of 0.5243, which tests in 64
  // bits at both levels (watertight does what a ray meets again); a transform unit of 0.2014.
  EXPECT_NEAR(base.at("unit_area_mm2").get<double>(), 4 * 0.0727 + 0.5243 + 0.2014, 0.0005);
  EXPECT_NEAR(wide.at("unit_area_over_default").get<double>(), 1.1731, 0.0005);
  EXPECT_GT(wide.at("energy_pj_per_ray").get<double>(), 1.5 * base.at("energy_pj_per_ray").get<double>());
}

void exact_pays_for_its_fall_back(const Json& report) {
  EXPECT_EQ(level(report, "double", "double", "two_step").at("exact_volumes_per_ray"), 0);
  const Json& exact = level(report, "exact", "double", "two_step");
  EXPECT_GT(exact.at("exact_volumes_per_ray"), 0);
  // Its tests are those of `double`, in another order and without a division, and the volumes: 168 products of 27-bit
  // multipliers in four passes.
  AccuracyConfig accuracy;
  accuracy.triangle = TriangleLevel::kExact;
  EXPECT_GT(app::test_energy_pj({.exact_volumes = 1}, accuracy), 168 * 4 * 3.7);
  EXPECT_GT(exact.at("energy_pj_per_ray").get<double>(),
            0.9 * level(report, "double", "double", "two_step").at("energy_pj_per_ray").get<double>());
}

void what_loses_rays_of_a_hard_case_is_not_safe_and_not_recommended(const Json& report) {
  EXPECT_EQ(level(report, "watertight", "conservative", "inverse_matrix").at("safe"), false);
  for (const Json& row : report.at("levels")) {
    std::uint64_t lost = 0;
    for (const Json& errors : row.at("hard"))
      lost += errors.at("missed").get<std::uint64_t>() + errors.at("extra").get<std::uint64_t>();
    EXPECT_TRUE(lost == 0 || row.at("safe") == false);
    for (const char* clock : {"host", "hardware"}) {
      EXPECT_TRUE(row.at("frontier").at(clock).is_boolean());
      const Json& chosen = report.at("recommended").at(clock);
      ASSERT_TRUE(chosen.is_object());
      const bool is_chosen = chosen.at("triangle") == row.at("triangle") && chosen.at("box") == row.at("box") &&
                             chosen.at("transform") == row.at("transform");
      EXPECT_TRUE(!is_chosen || row.at("safe") == true) << clock;
    }
  }
}

// One run for all: it takes a while, and each test is a process of its own.
TEST(AccuracyCommand, MeasuresWhatEachLevelGetsWrongAndCosts) {
  const Program program;
  program.write("a.yaml", kConfig);
  const Outcome outcome =
      program.run({"accuracy", "a.yaml", "--table", "--rays", "2000", "--hard-rays", "4000", "--repetitions", "2"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = Json::parse(program.read("out/a/accuracy.json"));
  finds_the_leaks_of_the_fast_level_and_none_of_the_watertight_ones(report);
  exact_tests_agree_with_the_reference_where_no_transform_rounds(report);
  one_inverse_matrix_loses_far_meshes(report);
  a_bounded_spawn_offset_never_hits_its_own_triangle(report);
  times_modelled_cycles_and_pictures_are_there(report);
  areas_and_energies_follow_the_levels(report);
  exact_pays_for_its_fall_back(report);
  what_loses_rays_of_a_hard_case_is_not_safe_and_not_recommended(report);
  EXPECT_THAT(outcome.out, HasSubstr("watertight"));
  EXPECT_THAT(outcome.out, HasSubstr("cheapest safe level"));
  EXPECT_THAT(outcome.out, HasSubstr("Monte Carlo: -0.50"));
  EXPECT_THAT(program.read("out/a/accuracy.html"), HasSubstr("fig-levels-on-hardware"));
  EXPECT_THAT(program.read("out/a/config.resolved.yaml"), HasSubstr("builtin: instances"));
  const Outcome again = program.run({"report", "out/a/accuracy.json"});  // each key stands in the schema
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST(AccuracyCommand, HonoursTheConfiguredPlanesAndBundles) {
  const Program program;
  program.write("a.yaml", std::string(kConfig) + "cull_planes: {count: 2}\nbundles: {size: 4}\n");
  const Outcome outcome =
      program.run({"accuracy", "a.yaml", "--table", "--rays", "300", "--hard-rays", "100", "--repetitions", "1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = Json::parse(program.read("out/a/accuracy.json"));
  const Json& base = level(report, "watertight", "conservative", "two_step");
  EXPECT_EQ(base.at("cull_planes"), true);
  EXPECT_GT(base.at("plane_tests_per_ray"), 0);
  EXPECT_GT(base.at("bundle_tests_per_ray"), 0);
  const Json& fast = level(report, "fast", "plain", "two_step");  // planes could lose its hits
  EXPECT_EQ(fast.at("cull_planes"), false);
  EXPECT_EQ(fast.at("plane_tests_per_ray"), 0);
  EXPECT_THAT(outcome.out, HasSubstr("without cull planes"));
}

/// Before a floor: a mask whose alpha runs from corner to corner, a lens that half of the light passes, and a ball of
/// which as much passes, stretched and moved.
std::string surfaces_that_let_light_through() {
  scene::GltfBuilder b;
  b.json["materials"] = Json::parse(R"([
    {"doubleSided": true},
    {"doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.5},
    {"doubleSided": true, "alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}])");
  const int positions = b.square_positions();
  const int colors = b.floats({1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 0}, "VEC4", 4);
  const int indices = b.accessor(b.view(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}), 5123, 6, "SCALAR");
  const auto square = [&](int material, Json translation, bool colored) {
    Json attributes = {{"POSITION", positions}};
    if (colored) attributes["COLOR_0"] = colors;
    b.mesh(attributes, indices, {{"material", material}});
    b.json["nodes"].back().update(
        {{"translation", std::move(translation)}, {"rotation", {0.1826, 0.3651, 0.5477, 0.7303}}});
  };
  square(0, {0.1, -0.2, -3}, false);
  square(1, {0, 0, -0.3}, true);
  square(2, {0.2, 0.1, 0.4}, false);
  for (const double x : {-0.6, 0.7})
    b.node({{"translation", {x, 0.3, 0.1}},
            {"scale", {0.5, 0.31, 0.27}},
            {"extras", {{"carousel_sphere", {{"radius", 1.3}, {"material", 2}}}}}});
  return b.text();
}

/// Nothing is lost or met too much where no triangle is aimed at on purpose, at any level: so all but `fast` are safe.
void expect_levels_judged_as_on_opaque_scenes(const Json& report, bool flat_scene_is_exact) {
  for (const Json& row : report.at("levels")) {
    const std::string name = row.at("triangle").get<std::string>() + " " + row.at("box").get<std::string>();
    const Json& scene = row.at("scene");
    EXPECT_EQ(scene.at("missed").get<int>() + scene.at("extra").get<int>(), 0) << name;
    if (row.at("triangle") != "exact" || row.at("transform") == "inverse_matrix") continue;
    EXPECT_EQ(scene.at("other"), 0) << name;
    EXPECT_EQ(row.at("safe"), true) << name;
    EXPECT_TRUE(!flat_scene_is_exact || row.at("picture").at("differ") == 0) << name;
  }
  for (const char* clock : {"host", "hardware"}) EXPECT_TRUE(report.at("recommended").at(clock).is_object()) << clock;
}

Json accuracy_of(const Program& program, const std::string& scene) {
  program.write("a.yaml", scene +
                              "image: {width: 24, height: 24, samples: 2, max_depth: 4}\n"
                              "topology: {resources: 2}\nrays: {slots_per_resource: 64}\n");
  const Outcome outcome =
      program.run({"accuracy", "a.yaml", "--rays", "2000", "--hard-rays", "200", "--repetitions", "1"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Json::parse(program.read("out/a/accuracy.json"));
}

TEST(AccuracyCommand, JudgesMasksAndBlendedSurfacesAtTheirExactPoints) {
  const Program program;
  program.write("veils.gltf", surfaces_that_let_light_through());
  expect_levels_judged_as_on_opaque_scenes(accuracy_of(program, "scene: {file: veils.gltf}\n"), false);
}

TEST(AccuracyCommand, KnowsSpheres) {
  const Program program;
  const Json report = accuracy_of(program, "scene: {builtin: spheres, procedural: true, triangles: 2000}\n");
  expect_levels_judged_as_on_opaque_scenes(report, true);
}

// The exact answers heed what rays wish: with culled backs they are those of the same picture, and nothing is extra.
TEST(AccuracyCommand, HeedsTheFlagsOfRays) {
  const Program program;
  const Json report = accuracy_of(program,
                                  "scene: {builtin: spheres, triangles: 2000}\n"
                                  "shading: {camera_rays: {cull: front}, bounce_rays: {cull: back}}\n");
  expect_levels_judged_as_on_opaque_scenes(report, true);
}

TEST(AccuracyCommandErrors, TrafficHasNoPictures) {
  const Program program;
  program.write("t.yaml", "engine: {kind: cycle}\nworkload: {traffic: {pattern: uniform, rate: 0.1, packets: 10}}\n");
  const Outcome outcome = program.run({"accuracy", "t.yaml"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("workload"));
}

}  // namespace
}  // namespace carousel::accuracy_command_test

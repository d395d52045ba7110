// Joules and areas of the methods of testing, computed a second time from the counts of the report and from operations
// that stand here: a product, sum and comparison are 3.7, 0.9 and 0.1 pJ at 45 nm.
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/costs.h"
#include "ringbus/cycle/testers/level_cycles.h"
#include "tests/app/time/timed_run.h"

namespace carousel::method_prices_test {
namespace {

using Sets = std::vector<std::string>;

constexpr double kProductOf53Bits = 4 * 1.265625, kSumOf53Bits = 53.0 / 24;

/// Picojoules in 32 bits; a division is four products and sums.
constexpr double narrow(double products, double sums, double comparisons, double divisions = 0) {
  return 3.7 * (products + 4 * divisions) + 0.9 * (sums + 4 * divisions) + 0.1 * comparisons;
}
/// In 64 bits, where a division takes a step of Newton more.
constexpr double wide(double products, double sums, double comparisons, double divisions = 0) {
  return 3.7 * kProductOf53Bits * (products + 6 * divisions) + 0.9 * kSumOf53Bits * (sums + 6 * divisions) +
         0.2 * comparisons;
}

class MethodPrices : public TimedRun {
 protected:
  Json of(const Sets& sets, const char* scene = "{builtin: instances, instances: 20}") {
    Json r = report(std::string("scene: ") + scene +
                        "\nimage: {width: 24, height: 16, samples: 1, max_depth: 2}\n"
                        "topology: {resources: 2, shape: ring}\nrays: {slots_per_resource: 256}\n"
                        "energy: {profile: n45}\n",
                    sets);
    if (hits_.is_null()) hits_ = r["digest"];
    return r;
  }
  static double count(const Json& r, const char* kind) { return r["tests"][kind]["count"].get<double>(); }
  static double pj(const Json& r, const char* part) {
    return r["energy"]["parts"][part]["joules"].get<double>() * 1e12;
  }
  static double units_mm2(const Json& r) { return r["area"]["parts"]["test_units"]["mm2"].get<double>(); }
  static void expect(double found, double expected) { EXPECT_NEAR(found / expected, 1, 1e-6); }

  Json hits_;
};

TEST_F(MethodPrices, TrianglesCostWhatTheirLevelDoes) {
  const Json watertight = of({});
  EXPECT_GT(count(watertight, "refined"), 0);
  expect(pj(watertight, "triangle_tests"),
         narrow(21, 22, 9, 1) * count(watertight, "triangle") + wide(21, 22, 9, 1) * count(watertight, "refined"));
  const Json fast = of({"accuracy.triangle=fast"});
  EXPECT_EQ(count(fast, "refined"), 0);
  expect(pj(fast, "triangle_tests"), narrow(27, 24, 5, 1) * count(fast, "triangle"));
  const Json precise = of({"accuracy.triangle=double"});
  expect(pj(precise, "triangle_tests"), wide(21, 22, 9, 1) * count(precise, "triangle"));
  const Json exact = of({"accuracy.triangle=exact"});
  expect(pj(exact, "triangle_tests"),
         wide(21, 22, 9) * count(exact, "triangle") + wide(168, 168, 0) * count(exact, "exact_volumes"));
  EXPECT_LT(units_mm2(fast), units_mm2(watertight)) << "whose units test in 64 bits what a ray meets";
  EXPECT_EQ(units_mm2(precise), units_mm2(watertight));
  EXPECT_LT(units_mm2(exact), units_mm2(precise)) << "which divides";
}

TEST_F(MethodPrices, BoxesAndPlanes) {
  const Json plain = of({"cull_planes.count=4"}), wide_box = of({"accuracy.box=double"});
  expect(pj(plain, "box_tests"), narrow(6, 6, 10) * count(plain, "box"));
  EXPECT_GT(count(plain, "plane"), 0);
  expect(pj(plain, "plane_tests"), narrow(6, 6, 3, 1) * count(plain, "plane"));
  expect(pj(wide_box, "box_tests"), wide(6, 6, 10) * count(wide_box, "box"));
  // Four box units a resource, whose multipliers and adders are wider.
  const double square_mm2 = 6 * 7700e-6 * 1.265625 + 6 * 4184e-6 * kSumOf53Bits + 2 * 10 * 137e-6,
               usual_mm2 = 6 * 7700e-6 + 6 * 4184e-6 + 10 * 137e-6;
  EXPECT_NEAR(units_mm2(wide_box) - units_mm2(of({})), 2 * 4 * 0.126 * (square_mm2 / usual_mm2 - 1), 1e-4);
}

TEST_F(MethodPrices, TransformsAndInversions) {
  for (const char* const level : {"two_step", "inverse_matrix"}) {
    SCOPED_TRACE(level);
    const std::string set = std::string("accuracy.transform=") + level;
    const Json stored = of({set}), inverted = of({set, "accuracy.instance_data=forward"});
    EXPECT_EQ(count(stored, "inversions"), 0);
    expect(pj(stored, "transforms"), narrow(18, 15, 0) * count(stored, "transforms"));
    EXPECT_GT(count(inverted, "inversions"), 0);
    const bool whole = level == std::string("inverse_matrix");
    EXPECT_EQ(count(inverted, "full_inversions"), whole ? count(inverted, "inversions") : 0);
    expect(pj(inverted, "transforms"),
           narrow(18, 15, 0) * count(inverted, "transforms") +
               (whole ? narrow(39, 17, 0, 1) : narrow(30, 11, 0, 1)) * count(inverted, "inversions"));
  }
  const Json wide_steps = of({"accuracy.transform=two_step_double", "accuracy.instance_data=forward"});
  EXPECT_GT(count(wide_steps, "inversions"), 0);
  expect(pj(wide_steps, "transforms"),
         wide(18, 15, 0) * count(wide_steps, "transforms") + wide(30, 11, 0, 1) * count(wide_steps, "inversions"));
}

// One of two instances is nearly singular: 64 bits for it alone.
TEST_F(MethodPrices, NearlySingularInstancesArePaidFor) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/tests/data/patents/turned.gltf");
  Json scene = Json::parse(file);
  scene["nodes"][1]["scale"] = {1, 1, 0.0001};
  program_.write("thin.gltf", scene.dump());
  const Json r = of({"accuracy.instance_data=forward"}, "{file: thin.gltf}");
  const double in_double = count(r, "transforms_in_double"), inversions = count(r, "inversions_in_double");
  EXPECT_GT(in_double, 0);
  EXPECT_GT(inversions, 0);
  EXPECT_GT(count(r, "transforms"), in_double);
  EXPECT_GT(count(r, "inversions"), inversions);
  expect(pj(r, "transforms"), narrow(18, 15, 0) * (count(r, "transforms") - in_double) + wide(18, 15, 0) * in_double +
                                  narrow(30, 11, 0, 1) * (count(r, "inversions") - inversions) +
                                  wide(30, 11, 0, 1) * inversions);
}

TEST_F(MethodPrices, FusedSumsCostHalfAndChangeNothingElse) {
  const Sets sets{"accuracy.instance_data=forward", "cull_planes.count=4"};
  const auto with = [&](Sets more) {
    more.insert(more.begin(), sets.begin(), sets.end());
    return of(more);
  };
  for (const auto& [level, fused] : {std::pair{"two_step", 12.0}, std::pair{"inverse_matrix", 15.0}}) {
    const std::string set = std::string("accuracy.transform=") + level;
    hits_ = nullptr;
    const Json separate = with({set}), r = with({set, "accuracy.products=fused"});
    EXPECT_EQ(r["digest"], separate["digest"]);
    EXPECT_EQ(r["engine"]["cycles"], separate["engine"]["cycles"]);
    EXPECT_EQ(pj(r, "box_tests"), pj(separate, "box_tests")) << "a sum comes first";
    const bool whole = fused == 15;
    expect(pj(r, "transforms"), narrow(18, 15 - fused / 2, 0) * count(r, "transforms") +
                                    (whole ? narrow(39, 17 - 8 / 2.0 - 2, 0, 1) : narrow(30, 11 - 2 / 2.0 - 2, 0, 1)) *
                                        count(r, "inversions"));
    expect(pj(r, "plane_tests"), narrow(6, 6 - 5 / 2.0 - 2, 3, 1) * count(r, "plane"));
    EXPECT_LT(units_mm2(r), units_mm2(separate));
  }
}

TEST_F(MethodPrices, ANumberOfTheConfigurationStands) {
  const Json r = of({"energy.triangle=1000", "accuracy.triangle=double", "area.transform=2"});
  expect(pj(r, "triangle_tests"), 1000 * count(r, "triangle"));
  EXPECT_NEAR(units_mm2(r), 2 * (4 * 0.126 + 0.193 + 2), 1e-3);
  const Json again = of({"energy.triangle=1000"});
  expect(pj(again, "triangle_tests"),
         1000 * count(again, "triangle") + 1000 * wide(21, 22, 9, 1) / narrow(21, 22, 9, 1) * count(again, "refined"));
}

TEST(SilhouetteLatency, IsThatOfFewerOperations) {
  BundlesConfig bundles;
  EXPECT_EQ(ringbus::cycle::at_levels({}, {}, bundles).units[UnitKind::kBundle].latency_cycles, 13);
  bundles.form = BundlesConfig::Form::kSilhouette;
  EXPECT_EQ(ringbus::cycle::at_levels({}, {}, bundles).units[UnitKind::kBundle].latency_cycles, 9);
}

TEST(Operations, PageHasThemAll) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/docs/reference/costs.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const MethodRow& row : kMethods) {
    const Operations& o = row.operations;
    std::string line = "| " + std::string(row.name);
    for (const int number : {o.products, o.sums, o.comparisons, o.divisions, o.fused})
      line += " | " + std::to_string(number);
    EXPECT_NE(page.find(line + " | " + std::string(row.where) + " |\n"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace carousel::method_prices_test

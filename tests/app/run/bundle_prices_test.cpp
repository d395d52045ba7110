// What tests of bundles cost by their form: joules of their operations and areas of their units, computed a second time
// from the counts of the report and from numbers that stand here.
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/time/timed_run.h"

namespace carousel::bundle_prices_test {
namespace {

using BundlePrices = TimedRun;
using Sets = std::vector<std::string>;

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 3000}\nimage: {width: 24, height: 16, samples: 1, max_depth: 1}\n"
    "topology: {resources: 2, shape: ring, visit: owners}\nrays: {slots_per_resource: 512}\n"
    "packets: {rays: 32}\nbundles: {size: 16}\nenergy: {profile: n45}\n";

double tests(const nlohmann::ordered_json& r, const char* kind) {
  return r["tests"][kind]["count"].get<double>();
}
double pj(const nlohmann::ordered_json& r, const char* part) {
  return r["energy"]["parts"][part]["joules"].get<double>() * 1e12;
}
std::uint64_t busy(const nlohmann::ordered_json& r, const char* kind = "bundle") {
  std::uint64_t cycles = 0;
  for (const auto& resource : r["resources"]) cycles += resource["units"][kind]["busy"].get<std::uint64_t>();
  return cycles;
}
double units_mm2(const nlohmann::ordered_json& r) {
  return r["area"]["parts"]["test_units"]["mm2"].get<double>();
}

TEST_F(BundlePrices, AreThoseOfTheOperationsOfTheirForm) {
  const Json interval = report(kMachine), serial = report(kMachine, {"bundles.form=silhouette"}),
             parallel = report(kMachine, {"bundles.form=silhouette", "bundles.edges=parallel"});
  EXPECT_EQ(serial["digest"], interval["digest"]);
  EXPECT_EQ(parallel["digest"], interval["digest"]);
  EXPECT_EQ(tests(interval, "silhouettes"), 0);
  EXPECT_EQ(tests(interval, "edges"), 0);
  EXPECT_NEAR(pj(interval, "bundle_tests"), 28.6 * tests(interval, "bundle"), 1);
  for (const Json* r : {&serial, &parallel}) {
    EXPECT_GT(tests(*r, "edges"), tests(*r, "silhouettes"));
    EXPECT_LT(tests(*r, "reciprocals"), tests(interval, "reciprocals"));
    EXPECT_NEAR(pj(*r, "bundle_tests"),
                28.6 * (tests(*r, "bundle") - tests(*r, "silhouettes")) + 17.1 * tests(*r, "silhouettes") +
                    7.5 * tests(*r, "edges"),
                1);
  }
  for (const Json* r : {&interval, &serial, &parallel}) {
    // Rays are made with three reciprocals each.
    const double divisions = tests(*r, "reciprocals") + 3 * (*r)["shading"]["shaded"].get<double>();
    EXPECT_EQ(tests(*r, "transforms"), 0);
    EXPECT_NEAR(pj(*r, "reciprocals"), 18.4 * divisions, 1);
    EXPECT_EQ((*r)["energy"]["parts"]["reciprocals"]["events"], divisions);
    // A test is one event, however many edges it takes.
    EXPECT_EQ((*r)["energy"]["parts"]["bundle_tests"]["events"], tests(*r, "bundle"));
    EXPECT_FALSE((*r)["tests"]["bundles"]["sum"].contains("edges")) << "they stand in tests.edges";
    // What a bundle divides takes a cycle of a unit too.
    EXPECT_EQ(static_cast<double>(busy(*r, "reciprocal")), tests(*r, "reciprocals"));
  }
  // A test by intervals is a pass, and so is one by a silhouette whose edges are tested at once.
  EXPECT_EQ(static_cast<double>(busy(interval)), tests(interval, "bundle"));
  EXPECT_EQ(static_cast<double>(busy(parallel)), tests(parallel, "bundle"));
  EXPECT_LT(tests(serial, "edges"), tests(parallel, "edges"));
  // The cycles of two schedules differ by chance; those of the units do not.
  EXPECT_LT(busy(parallel), busy(serial));
  // A unit for intervals is a box unit; one for silhouettes has half of its products, and two for each edge at once.
  EXPECT_NEAR(units_mm2(serial) - units_mm2(interval), 2 * (0.085 + 0.0269 - 0.126), 1e-5);
  EXPECT_NEAR(units_mm2(parallel) - units_mm2(interval), 2 * (0.085 + 6 * 0.0269 - 0.126), 1e-5);
  const Json dearer = report(kMachine, {"bundles.form=silhouette", "area.edge=1.0269", "energy.edge=107.5"});
  EXPECT_NEAR(units_mm2(dearer) - units_mm2(serial), 2, 1e-5);
  EXPECT_NEAR(pj(dearer, "bundle_tests") - pj(serial, "bundle_tests"), 100 * tests(serial, "edges"), 1);
}

// A pair of blocks makes both tests of a box at once, and so is two units. A box unit that tests bundles as well has
// six edges at once only if it is as large as their unit.
TEST_F(BundlePrices, BlocksThatDoMoreAreLarger) {
  const Sets parallel{"bundles.order=parallel", "bundles.form=silhouette", "bundles.edges=parallel"},
      serial{"bundles.order=parallel", "bundles.form=silhouette"};
  const auto with = [&](Sets sets, const char* blocks) {
    sets.push_back(std::string("testers.bundle_blocks=") + blocks);
    return units_mm2(report(kMachine, sets));
  };
  const double unit = 0.085 + 6 * 0.0269, box = 0.126, separate = with(parallel, "separate");
  EXPECT_NEAR(with(parallel, "pairs") - separate, 2 * unit, 1e-5);
  // Four box units a resource, each as large as the unit that is left out.
  EXPECT_NEAR(with(parallel, "shared") - separate, 2 * (4 * (unit - box) - unit), 1e-5);
  EXPECT_NEAR(with(serial, "separate") - with(serial, "shared"), 2 * (0.085 + 0.0269), 1e-5);
}

// One node holds all of its leaves: bundles are tested against no box there, and divide only for primitives.
TEST_F(BundlePrices, WithoutABoxNothingIsDivided) {
  const char* const kOneNode =
      "scene: {builtin: terrain, triangles: 16}\nimage: {width: 16, height: 16, samples: 1, max_depth: 1}\n"
      "bvh: {width: 8, leaf_triangles: 4, mixed_triangles: 4}\ntopology: {resources: 2}\npackets: {rays: 32}\n"
      "bundles: {size: 8}\n";
  for (const char* const form : {"bundles.form=interval", "bundles.form=silhouette"}) {
    const Json rays = report(kOneNode, {form}), primitives = report(kOneNode, {form, "bundles.leaf=primitives"});
    ASSERT_EQ(rays["structure"]["inner_nodes"], 1);
    EXPECT_EQ(tests(rays, "bundle"), 0);
    EXPECT_EQ(tests(rays, "reciprocals"), 0) << form;
    const double triangles = rays["structure"]["primitives"], bundles = tests(primitives, "bundle") / triangles;
    EXPECT_GT(bundles, 0);
    EXPECT_EQ(tests(primitives, "reciprocals"), 6 * bundles) << form;
  }
}

// A slow divider holds intervals up, and silhouettes, which divide less and behind their tests, by less.
TEST_F(BundlePrices, DivisionsTakeTime) {
  const auto more = [&](Sets sets) {
    const double fast = report(kMachine, sets)["engine"]["cycles"];
    sets.insert(sets.end(), {"testers.reciprocal.interval_cycles=16", "testers.reciprocal.latency_cycles=60"});
    return report(kMachine, sets)["engine"]["cycles"].get<double>() / fast;
  };
  const double interval = more({}), silhouette = more({"bundles.form=silhouette", "bundles.edges=parallel"});
  EXPECT_GT(interval, 1.05);
  EXPECT_LT(silhouette, interval);
}

}  // namespace
}  // namespace carousel::bundle_prices_test

// Distributions, depths and ways of rays, against counts and integrals that come from elsewhere.
#include <cmath>

#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::ray_ways_test {
namespace {

class RayWays : public TimedRun {
 protected:
  static constexpr const char* kMachine =
      "scene: {builtin: instances, instances: 40}\nimage: {width: 24, height: 16, samples: 1, max_depth: 3}\n"
      "topology: {resources: 3}\nrays: {slots_per_resource: 64}\npackets: {rays: 16}\ncollections: {ready: 16}\n";

  /// The integral of a quantity of the whole machine over the run.
  static double integral(const Json& report, const std::string& quantity) {
    double sum = 0;
    for (const Json& row : report["time_series"]["rows"])
      if (row["part"] == "machine" && row["quantity"] == quantity)
        for (const Json& value : row["values"]) sum += value.get<double>();
    return sum * report["time_series"]["interval"].get<double>();
  }
  static double sum_of(const Json& distribution) {
    std::uint64_t counted = 0;
    for (const Json& row : distribution["classes"]) {
      counted += row["count"].get<std::uint64_t>();
      EXPECT_LE(row["from"], row["to"]);
    }
    EXPECT_EQ(counted, distribution["count"]);
    return distribution["mean"].get<double>() * distribution["count"].get<double>();
  }
  static std::uint64_t count(const Json& rows, const char* key) {
    std::uint64_t sum = 0;
    for (const Json& row : rows) sum += row[key].get<std::uint64_t>();
    return sum;
  }
};

// By Little's law the times that rays hold slots add up to the integral of the slots held, and likewise for
// collections.
TEST_F(RayWays, TimesAddUpToWhatWasHeld) {
  for (const char* set : {"topology.shape=ring", "collections.traversal=ordered", "bundles.size=8",
                          "topology.shape=independent", "collections.partial=after"}) {
    SCOPED_TRACE(set);
    const Json r = report(kMachine, {set, "engine.threads=2"});
    const Json& residence = r["rays"]["residence"];
    EXPECT_EQ(residence["count"], r["rays"]["completed"]);
    if (std::string(set) != "bundles.size=8") {  // whose records are held too
      EXPECT_NEAR(sum_of(residence), integral(r, "rays held"), 1e-6 * sum_of(residence));
    }
    ASSERT_EQ(r["collections"].contains("age"), std::string(set) != "topology.shape=independent");
    if (!r["collections"].contains("age")) continue;
    const Json& age = r["collections"]["age"];
    EXPECT_EQ(age["count"], r["packets"]["issued"]);
    EXPECT_NEAR(sum_of(age), integral(r, "open collections"), 1e-6 * sum_of(age));
  }
  const Json native = report(kMachine, {"engine.kind=native", "engine.threads=1"});
  EXPECT_FALSE(native["rays"].contains("residence"));
  EXPECT_FALSE(native["collections"].contains("age"));
}

// Each ray is tested at the root, and once for each child that it hits. Work at all depths is the work in all.
TEST_F(RayWays, DepthsAddUp) {
  for (const char* set :
       {"collections.traversal=spread", "collections.traversal=treelet", "collections.traversal=ordered",
        "packets.shapes=single", "engine.kind=native", "bundles.size=8"}) {
    SCOPED_TRACE(set);
    const Json r = report(kMachine, {set, "engine.threads=1"});
    const Json& depths = r["nodes"]["by_depth"];
    EXPECT_EQ(count(depths, "box_tests"), r["tests"]["box"]["count"]);
    EXPECT_EQ(count(depths, "triangle_tests"), r["tests"]["triangle"]["count"]);
    EXPECT_EQ(count(depths, "visits"), count(r["resources"], "packets_seen") - count(r["resources"], "bubbles"));
    EXPECT_EQ(depths[0]["inner_nodes"], 1);
    EXPECT_GE(count(depths, "leaves"), 40);
    EXPECT_LE(count(depths, "misses"), count(depths, "rays"));
    if (std::string(set) != "bundles.size=8") {
      EXPECT_EQ(count(depths, "rays"), count(r["resources"], "rays_tested"));
    }
    const bool all_children =
        std::string(set) != "collections.traversal=ordered" && std::string(set) != "packets.shapes=single";
    if (all_children) {
      EXPECT_EQ(depths[0]["rays"], r["rays"]["completed"]);
    }
    for (std::size_t d = 0; all_children && d + 1 < depths.size(); ++d) {
      EXPECT_EQ(depths[d]["children_hit"], depths[d + 1]["rays"]) << "depth " << d;
    }
  }
  EXPECT_FALSE(report(kMachine, {"topology.shape=independent"}).contains("nodes"));
}

TEST_F(RayWays, RaysGoOnFromBounceToBounce) {
  for (const char* set : {"engine.kind=native", "primary=raster", "engine.kind=cycle"}) {
    SCOPED_TRACE(set);
    const Json r = report(kMachine, {set});
    const Json &rows = r["rays"]["by_bounce"], &kinds = r["rays"]["by_kind"];
    ASSERT_EQ(rows.size(), 3u);
    const bool raster = std::string(set) == "primary=raster";
    EXPECT_EQ(rows[0]["rays"], kinds["camera"]);
    EXPECT_EQ(rows[0]["begun"], raster ? 0 : 24 * 16);
    EXPECT_EQ(count(rows, "rays"), kinds["camera"].get<std::uint64_t>() + kinds["bounce"].get<std::uint64_t>());
    EXPECT_EQ(count(rows, "shadow"), kinds["shadow"]);
    std::uint64_t came = 0;  // from the bounce before
    for (const Json& row : rows) {
      const auto at = [&](const char* key) { return row[key].get<std::uint64_t>(); };
      EXPECT_EQ(at("rays"), at("begun") + came);
      EXPECT_EQ(at("rays"), at("escaped") + at("went_on") + at("absorbed"));
      EXPECT_EQ(at("hit"), at("went_on") + at("absorbed"));
      EXPECT_EQ(at("shadow"), at("lit") + at("occluded") + at("passed"));
      came = at("went_on");
    }
    EXPECT_EQ(came, 0u);
    if (raster) {
      EXPECT_GT(rows[1]["begun"], 0);
    }
  }
}

// Independent resources take each ray down depth first with code of their own.
TEST_F(RayWays, BaselineMakesTheTestsOfIndependentResources) {
  const Json one = report(kMachine, {"topology.shape=independent"});
  const Json& baseline = one["tests"]["depth_first"];
  EXPECT_EQ(baseline["one_in"], 1);
  EXPECT_EQ(baseline["rays"], one["rays"]["completed"]);
  EXPECT_EQ(baseline["box"], one["tests"]["box"]);
  // Children that a ray enters at the same distance are taken in another order, so a leaf more or less is tested.
  const auto triangles = one["tests"]["triangle"]["count"].get<double>();
  EXPECT_NEAR(baseline["triangle"]["count"].get<double>(), triangles, triangles / 500);
  const Json ring = report(kMachine, {"engine.threads=2"});
  EXPECT_EQ(ring["tests"]["depth_first"], baseline);
  EXPECT_GT(ring["tests"]["box"]["count"], baseline["box"]["count"]);
}

// Some of many rays are traced again, whoever shaded them.
TEST_F(RayWays, ALargeRunIsSampled) {
  const std::vector<std::string> sets{"image.width=96", "image.height=64", "engine.kind=native"};
  const auto run = [&](const char* threads) {
    std::vector<std::string> all = sets;
    all.push_back(threads);
    return report(kMachine, all)["tests"]["depth_first"];
  };
  const Json one = run("engine.threads=1");
  EXPECT_EQ(one["one_in"], 2);  // 96 * 64 paths of at most 6 rays, above 32,768
  EXPECT_GT(one["rays"], 3000);
  EXPECT_EQ(run("engine.threads=2"), one);
}

}  // namespace
}  // namespace carousel::ray_ways_test

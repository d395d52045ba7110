// The examples of docs/guides/extending.md, taken from the page when cmake configures and used through the public
// interfaces.
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/reader.h"
#include "core/config/tree/tree.h"
#include "own_counts.h"
#include "own_effect.h"
#include "own_policy.h"
#include "own_section.h"
#include "own_topology.h"
#include "own_unit.h"
#include "shading/effects/effects_plan.h"
#include "shading/surface/material_properties.h"

namespace carousel {
namespace {

CurvesConfig read_curves(const std::string& text, std::vector<ConfigIssue>& issues) {
  CurvesConfig curves;
  config::Reader(issues, {}).read(config::parse_yaml(text, "own.yaml", issues), curves);
  return curves;
}

TEST(Extending, ASectionIsReadFromItsDescription) {
  std::vector<ConfigIssue> issues;
  const CurvesConfig curves = read_curves("segments: 12\nbasis: b_spline\n", issues);
  EXPECT_TRUE(issues.empty());
  EXPECT_EQ(curves.segments, 12);
  EXPECT_EQ(curves.widest, 0.5f);
  EXPECT_EQ(curves.basis, CurvesConfig::Basis::kBSpline);
}

TEST(Extending, ASectionsErrorsNamePlaceRangeAndNearestName) {
  std::vector<ConfigIssue> issues;
  const CurvesConfig curves = read_curves("segments: 99\nbasis: bspline\n", issues);
  EXPECT_EQ(curves.segments, 8);
  ASSERT_EQ(issues.size(), 2u);
  for (const char* part : {"own.yaml:1:11", "segments", "1 to 64", "99"})
    EXPECT_NE(issues[0].text().find(part), std::string::npos) << issues[0].text();
  EXPECT_NE(issues[1].text().find("b_spline"), std::string::npos) << issues[1].text();
}

/// A visitor of the report that keeps each key with its value.
struct Keys {
  std::vector<std::pair<std::string, std::uint64_t>> found;
  void field(const char* key, std::uint64_t value, const char*, const char*) { found.emplace_back(key, value); }
};

TEST(Extending, CountersAddAndDescribeThemselves) {
  CurveCounts sum{2, 10};
  sum += CurveCounts{1, 5};
  Keys keys;
  describe(keys, sum);
  const decltype(keys.found) expected{{"tests", 3}, {"segments", 15}, {"work", 18}};
  EXPECT_EQ(keys.found, expected);
}

TEST(Extending, APolicyOrdersCollections) {
  using namespace ringbus;
  const PolicyScale scale{.ready = 32, .max_depth = 9, .scene_size = 1};
  const auto bucket = [&](std::uint16_t depth, std::uint32_t rays) {
    return kShallowest.bucket({.key = {}, .rays = rays, .entry = 0, .depth = depth}, scale);
  };
  EXPECT_LT(bucket(0, 1), bucket(1, 40));
  EXPECT_LT(bucket(3, 40), bucket(3, 31));
  EXPECT_EQ(bucket(60000, 1), PriorityLists::kBuckets - 1);
}

TEST(Extending, ATopologyIsItsPlan) {
  TopologyConfig config;
  config.resources = 8;
  const ringbus::TopologyPlan plan = ringbus::plan_express_ring(config);
  EXPECT_EQ(plan.wires.size(), 16u);
  EXPECT_FALSE(plan.verdict.can_deadlock) << plan.verdict.rule;
  EXPECT_EQ(plan.ack_directions.size(), plan.successors.size());  // so traffic can run on it
  for (const std::vector<ResourceId>& successors : plan.successors) {
    std::set<std::uint32_t> visited;
    ResourceId at(0);
    for (int i = 0; i < 8; ++i) visited.insert((at = successors[at.value]).value);
    EXPECT_EQ(visited.size(), 8u);
    EXPECT_EQ(at, ResourceId(0));
  }
  config.flow = Flow::kNone;
  EXPECT_TRUE(ringbus::plan_express_ring(config).verdict.can_deadlock);
}

TEST(Extending, AUnitKindTakesTheTimesOfItsRow) {
  ringbus::cycle::UnitBank bank = make_bank(kCurveUnit);
  const auto first = bank.reserve(100, 5);  // three starts, two units
  EXPECT_EQ(first.first, 112u);
  EXPECT_EQ(first.last, 114u);
  EXPECT_EQ(bank.reserve(100, 1).first, 115u);
}

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(CAROUSEL_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The page shows the declaration of a part of the product, which is compiled everywhere, and the list that names it.
TEST(Extending, AWholePartIsShownAsItStandsInTheProduct) {
  const std::string page = text_of("docs/guides/extending.md"), part = text_of("core/config/parts/stride_prefetcher.h"),
                    list = text_of("core/config/parts.h");
  EXPECT_NE(page.find("```cpp\n" + part + "```"), std::string::npos) << "the declaration";
  EXPECT_NE(page.find("using Parts = PartList<StridePrefetcherPart>;\n"), std::string::npos);
  EXPECT_NE(list.find("using Parts = PartList<StridePrefetcherPart>;\n"), std::string::npos);
}

TEST(Extending, AnEffectFollowsFromItsRule) {
  using namespace shading;
  scene::Scene scene;
  scene::Material glass;
  glass.name = "frosted";
  glass.metallic = 0;
  glass.roughness = 0.5f;
  glass.transmission.weight = 1;
  scene.materials = {glass};
  const std::vector<bool> reached{true};
  const EffectsPlan none;
  Config config;
  config.shading.cycles_per_lookup = 7;
  config.shading.products_per_cycle = 10;
  const PlannedEffect planned = find_callers(kFrostedGlass, {scene, config, reached, none});
  EXPECT_TRUE(planned.called_for);
  EXPECT_EQ(planned.why, "material frosted");
  const EffectCost cost = cost_of(kFrostedGlass, config, 3);
  EXPECT_EQ(cost.cycles_per_hit, 7u + 6);  // a lookup, and 54 products
  EXPECT_EQ(cost.products, 54u);
  EXPECT_EQ(cost.texture_reads, 1u);
  EXPECT_EQ(cost.path_state_bytes, 12u);
  kFrostedGlass.disable_in_material(scene.materials[0]);
  EXPECT_FALSE(find_callers(kFrostedGlass, {scene, config, reached, none}).called_for);
  scene.materials = {glass};
  scene.materials[0].metallic = 1;
  EXPECT_FALSE(requires_effect(kFrostedGlass, scene.materials[0]));
}

}  // namespace
}  // namespace carousel

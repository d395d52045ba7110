// The examples of docs/extending.md, taken from the page when cmake configures and used through the public interfaces.
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "core/config/reader.h"
#include "core/config/row_walk.h"
#include "core/config/tree/tree.h"
#include "own_counts.h"
#include "own_effect.h"
#include "own_policy.h"
#include "own_prefetcher.h"
#include "own_section.h"
#include "own_topology.h"
#include "own_unit.h"
#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/time/windows.h"
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

namespace prefetching {

using namespace ringbus;
using namespace ringbus::cycle;

/// Asks for every third line, the next when the last has come, and tells the prefetcher, if there is one.
class Reader final : public Agent {
 public:
  Reader(Channel<FetchRequest>& requests, Channel<FetchAnswer>& answers, Channel<PrefetchHint>* hints)
      : requests_(requests), answers_(answers), hints_(hints) {}
  Cycle next() const override { return asked_ == 0 ? 1 : answers_.next(); }
  bool polled() const override { return false; }
  void run(Cycle end) override {
    for (Cycle now; (now = next()) < end;) {
      if (asked_ > 0) answers_.take(), done_ = now;
      if (asked_ == kLines) return;
      const std::uint64_t line = 1000 + 3 * asked_++;
      requests_.send(now + 1, {line, 1});
      if (hints_ != nullptr) hints_->send(now + 1, {line});
    }
  }
  std::string describe() const override { return ""; }
  Cycle done() const { return done_; }
  static constexpr std::uint64_t kLines = 200;

 private:
  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  Channel<PrefetchHint>* hints_;
  std::uint64_t asked_ = 0;
  Cycle done_ = 0;
};

struct Outcome {
  Cycle cycles = 0;
  CacheCounts cache;
  PrefetchCounts counts;
  std::vector<ByteRow> rows;
};

/// The reader, an L2 and its memory on two threads; `prefetch`: null for a machine without a prefetcher.
Outcome run(const PrefetchConfig* prefetch) {
  MemoryConfig memory;
  memory.l2_kib = 16;
  memory.l2_latency_cycles = 20;
  memory.dram_latency_cycles = 200;
  const LinkConfig link;
  enum Number : std::uint32_t { kReader, kCache, kMemory, kPrefetcher };
  ChannelList list;
  const FetchKinds kinds(list, memory, 32);
  const MemoryKinds lines(list, memory);
  const Cycle there = ShapeCache::request_latency(memory), back = ShapeCache::answer_latency(memory);
  Channel<FetchRequest> requests(list.at(kinds.requests, {kReader, kCache, 1}));
  Channel<FetchAnswer> answers(list.at(kinds.data, {kCache, kReader, back}));
  Channel<std::uint64_t> down(list.at(lines.requests, {kCache, kMemory, MemoryAgent::request_latency(memory)}));
  Channel<std::uint64_t> up(list.at(lines.lines, {kMemory, kCache, MemoryAgent::answer_latency(memory)}));
  std::vector<ShapeCache::Client> clients{{&requests, &answers}};
  std::optional<Channel<PrefetchHint>> hints;
  std::optional<Channel<FetchRequest>> ahead;
  std::optional<Channel<FetchAnswer>> come;
  std::optional<StridePrefetcher> prefetcher;
  if (prefetch != nullptr) {
    const PrefetchKinds of(list, memory, link);
    hints.emplace(list.at(of.hints, {kReader, kPrefetcher, 1}));
    ahead.emplace(list.at(of.requests, {kPrefetcher, kCache, there}));
    come.emplace(list.at(of.lines, {kCache, kPrefetcher, back}));
    clients.push_back({&*ahead, &*come});
    prefetcher.emplace(*prefetch, memory, link, StridePrefetcher::Ports{*hints, *ahead, *come});
  }
  ShapeCache cache(memory, clients, down, up);
  const std::unique_ptr<MemoryAgent> dram = make_memory(memory, 1000, {{&down, &up}});
  Reader reader(requests, answers, hints ? &*hints : nullptr);
  std::vector<std::vector<Agent*>> parts{{&reader, &cache}, {dram.get()}};
  std::vector<const Agent*> agents{&reader, &cache, dram.get()};
  if (prefetcher) {
    parts.back().push_back(&*prefetcher);
    agents.push_back(&*prefetcher);
  }
  WakeupTable wakeups(parts);
  list.connect(wakeups, agents);
  run_windows(parts, wakeups, list.least_latency(), [](Cycle) { return true; });
  return {reader.done(), cache.statistics(), prefetcher ? prefetcher->counts() : PrefetchCounts{}, list.rows()};
}

}  // namespace prefetching

TEST(Extending, APartChangesTheMachineAndItsWiresAreInTheLedger) {
  using prefetching::Reader;
  const prefetching::Outcome without = prefetching::run(nullptr);
  EXPECT_EQ(without.cache.misses, Reader::kLines);
  const PrefetchConfig config;
  const prefetching::Outcome with = prefetching::run(&config);
  EXPECT_EQ(with.counts.hints, Reader::kLines);
  EXPECT_EQ(with.counts.streams, 1u);
  // Three lines until it is sure of the stride; from then on each line but the first of them is asked for ahead.
  EXPECT_EQ(with.counts.lines, Reader::kLines - 3 + 2);
  EXPECT_LT(2 * with.cycles, without.cycles);
  Keys keys;
  describe(keys, with.counts);
  const decltype(keys.found) shown{
      {"hints", with.counts.hints}, {"streams", with.counts.streams}, {"lines", with.counts.lines}};
  EXPECT_EQ(keys.found, shown);
  ASSERT_EQ(with.rows.size(), without.rows.size() + 3);
  const std::array<std::uint64_t, 3> bytes{8 * with.counts.hints, 16 * with.counts.lines, 64 * with.counts.lines};
  for (std::size_t i = 0; i < 3; ++i) {
    const ByteRow& row = with.rows[without.rows.size() + i];
    EXPECT_EQ(row.bytes, bytes[i]) << row.what;
    EXPECT_EQ(row.bytes, row.bytes_taken) << row.what;
  }
}

TEST(Extending, MoreLinesAheadHideMoreOfTheLatency) {
  PrefetchConfig config;
  const ringbus::Cycle two = prefetching::run(&config).cycles;
  config.lines = 4;
  EXPECT_LT(prefetching::run(&config).cycles, two);
  config.lines = 0;
  EXPECT_EQ(prefetching::run(&config).cycles, prefetching::run(nullptr).cycles);
}

/// Keeps the class by which each key of a section is relaxed.
struct RelaxedKeys : config::RowWalk<RelaxedKeys> {
  std::vector<std::pair<std::string, std::string>> found;
  struct Rest {
    RelaxedKeys& to;
    std::string path;
    template <class... Args>
    Rest relax(const char* part, const Args&...) const {
      to.found.emplace_back(path, part);
      return *this;
    }
    template <class... Args>
    Rest only(const Args&...) const {
      return *this;
    }
  };
  template <class T>
  Rest rest(std::string path, T&) {
    return {*this, std::move(path)};
  }
};

TEST(Extending, APartSaysWhatIsRelaxedAndWhatItCosts) {
  PrefetchConfig prefetch;
  RelaxedKeys keys;
  config::describe(keys, prefetch);
  const decltype(keys.found) expected{{"lines", "prefetch"}};
  EXPECT_EQ(keys.found, expected);
  const Config none,
      machine = load_config({"scene: {builtin: cornell}\nengine: {kind: cycle}\nenergy: {profile: n45}\n", "own.yaml"})
                    .config;
  EXPECT_EQ(ringbus::cycle::area_mm2(prefetch, none), 0);
  prefetch.streams = 64;  // a KiB
  EXPECT_FLOAT_EQ(static_cast<float>(ringbus::cycle::area_mm2(prefetch, machine)), 0.00456f);
  EXPECT_GT(ringbus::cycle::joules({.hints = 2}, prefetch, machine), 0);
  EXPECT_EQ(ringbus::cycle::joules({}, prefetch, machine), 0);
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

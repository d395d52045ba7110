// The keys that a machine ignores are named. Where a key is named, no other value of it changes a run; where the table
// of rows (key_rows.h) shows that a key does something, it is not named.
#include <algorithm>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands/check_command.h"
#include "core/config/key_conditions.h"
#include "core/config/write.h"
#include "core/system/error.h"
#include "ringbus/results/run_features.h"
#include "tests/accel/traverse/simd_guard.h"
#include "tests/app/keys/key_runs.h"

namespace carousel::ignored_keys_test {
namespace {

using enum BaseMachine;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class IgnoredKeys : public KeyRuns {
 protected:
  std::vector<std::string> ignored(BaseMachine machine, const std::vector<std::string>& sets) {
    std::vector<std::string> out;
    for (const IgnoredKey& one :
         app::prepare(arguments(machine, sets), {.force = true, .frames = true}, false).ignored())
      out.push_back(one.key);
    return out;
  }
};

struct Machine {
  BaseMachine base;
  std::vector<std::string> sets;
};

/// A value of each key that has a row, other than the machine's own.
std::map<std::string, std::string> other_values(const Config& config) {
  std::map<std::string, std::string> out;
  const KeyOutcome::Json own = config_json(config);
  for (const KeyRow& row : key_rows()) {
    std::string path = "/" + row.key;
    std::replace(path.begin(), path.end(), '.', '/');
    const KeyOutcome::Json::json_pointer at(path);
    const std::string now = !own.contains(at) ? "" : own[at].is_string() ? own[at].get<std::string>() : own[at].dump();
    for (const std::string& value : values_of(row))
      if (value != now) out.emplace(row.key, value);
  }
  return out;
}

/// The result without the list of what a part would cost, used or not, without counters that are all zero, and for rays
/// that are not shaded without the list of effects.
std::string felt_part(std::string result, bool shaded) {
  if (const std::size_t effects = result.find("\"effects\":["); effects != result.npos && !shaded)
    result.erase(effects, result.find("\"bound\":", effects) - effects);
  if (const std::size_t costs = result.find("\"costs\":["); costs != result.npos)
    result.erase(costs, result.find(']', costs) - costs);
  const std::string zeros = ",\"transformed_rays\":{\"written_bytes\":0,\"read_bytes\":0,\"peak_bytes\":0}";
  for (std::size_t at; (at = result.find(zeros)) != result.npos;) result.erase(at, zeros.size());
  return result;
}

// All of them at once: a change of one of them would show.
TEST_F(IgnoredKeys, ChangeNothing) {
  const std::vector<Machine> machines{
      {kTerrain, {"topology.resources=1"}},
      {kTerrain, {"topology.shape=independent"}},
      {kTerrain, {"topology.shape=independent", "testers.simt.warp=8"}},
      {kTerrain, {"topology={shape: graph, trace: stacks, nodes: [{name: r, count: 3}]}"}},
      {kTerrain, {"topology.shape=central", "topology.resources=1", "testers.simd.lanes=8"}},
      {kTerrain, {"topology.shape=central", "topology.form=distributor", "topology.resources=1"}},
      {kTerrain, {"collections.home=local", "memory.dram.preset=hbm2_2", "energy.profile=n45"}},
      {kTerrain, {"topology.shape=bus", "collections.traversal=treelet", "memory.dram.refresh=false"}},
      {kLayers, {"testers.any_hit=shader"}},
      {kProcedural, {"collections.traversal=ordered", "energy.profile=n7"}},
      {kCornell, {}},
      {kBundles, {"bundles.order=parallel", "testers.bundle_blocks=shared"}},
      {kTraffic, {}},
  };
  for (const Machine& machine : machines) {
    SCOPED_TRACE(text(machine.base) + testing::PrintToString(machine.sets));
    const app::Prepared prepared = app::prepare(arguments(machine.base, machine.sets), {.force = true}, false);
    const SceneFacts facts = ringbus::scene_facts(prepared.accel);
    std::vector<std::string> sets = machine.sets;
    std::set<std::string> changed;
    for (const auto& [key, value] : other_values(prepared.config())) {
      if (!unused_because(prepared.config(), facts, key)) continue;
      if (key.starts_with("workload.") && machine.base != kTraffic) continue;  // it would be another workload
      sets.push_back(key + "=" + value);
      try {  // some values need others, or are not what the engine has
        Config other = load_config({text(machine.base), "machine.yaml"}, sets, {.force = true}).config;
        changed.insert(key);
      } catch (const ConfigError&) {
        sets.pop_back();
      }
    }
    EXPECT_GT(changed.size(), 60u) << testing::PrintToString(changed);
    const KeyOutcome base = run(machine.base, machine.sets), other = run(machine.base, sets);
    ASSERT_EQ(other.refusal, "");
    const std::string expected = felt_part(base.result, machine.base != kCornell),
                      found = felt_part(other.result, machine.base != kCornell);
    const auto at = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
    if (found == expected) continue;
    const auto from = static_cast<std::size_t>(at.first - found.begin());
    ADD_FAILURE() << found.substr(from - std::min<std::size_t>(from, 200), 300) << "\n" << testing::PrintToString(sets);
  }
}

// KeyEffects shows that each row's key does something on its machine.
TEST_F(IgnoredKeys, AreNoneThatDoSomething) {
  std::map<BaseMachine, SceneFacts> facts;
  for (const KeyRow& row : key_rows()) {
    if (row.key.starts_with("energy.") || row.key.starts_with("area.")) continue;  // listed, used or not
    if (!facts.contains(row.machine))
      facts[row.machine] = ringbus::scene_facts(app::prepare(arguments(row.machine, {}), {.force = true}, false).accel);
    const Config config = load_config({text(row.machine), "machine.yaml"}, row.sets, {.force = true}).config;
    const auto why = unused_because(config, facts[row.machine], row.key);
    EXPECT_FALSE(why) << row.key << " of " << text(row.machine) << testing::PrintToString(row.sets) << ": "
                      << why.value_or("");
  }
}

// Before issue 45 units that no ray needs had an area.
TEST_F(IgnoredKeys, OfUnitsHaveNoArea) {
  const std::string opaque = run(kTerrain, {"energy.profile=n45"}).result;
  EXPECT_EQ(run(kTerrain, {"energy.profile=n45", "testers.any_hit_unit=50", "testers.plane=50"}).result, opaque);
  EXPECT_NE(run(kLayers, {"energy.profile=n45", "testers.any_hit_unit=50"}).result,
            run(kLayers, {"energy.profile=n45"}).result);
}

TEST_F(IgnoredKeys, AreThoseThatTheUserSets) {
  EXPECT_THAT(ignored(kTerrain, {}), IsEmpty());
  EXPECT_THAT(ignored(kTerrain, {"topology.rings=2", "testers.distributor.queue=8"}),
              ElementsAre("testers.distributor.queue", "topology.rings"))  // at their defaults, too
      << "given in the order of their names";
  EXPECT_THAT(
      ignored(kCornell, {"image.samples=2", "shading.camera_rays.cull=back"}),
      ElementsAre("image.height", "image.max_depth", "image.samples", "image.width", "shading.camera_rays.cull"));
  EXPECT_THAT(ignored(kTerrain, {"topology.shape=independent", "testers.contexts=4"}),
              ElementsAre("collections.capacity", "collections.ready", "testers.contexts"));
  EXPECT_THAT(ignored(kTerrain, {"scene.sky.color=[1, 0, 0]", "testers={any_hit_unit: 50, box: {units: 2}}"}),
              ElementsAre("testers.any_hit_unit"));
  EXPECT_THAT(ignored(kLayers, {"testers.any_hit_unit=50"}), IsEmpty());
  const std::string lists = "engine.lanes=rays", treelets = "collections.traversal=treelet";
  EXPECT_THAT(ignored(kNative, {lists, treelets}), IsEmpty());
  for (const char* other : {"accuracy.box=double", "bvh.storage=quantised", "bvh.elements=spheres"})
    EXPECT_THAT(ignored(kNative, {lists, treelets, other}), ElementsAre("engine.lanes")) << other;
  const accel::SimdGuard guard;
  for (const SimdTarget target : accel::usable_simd_targets()) {
    const bool wide = target == SimdTarget::kAuto || target == SimdTarget::kAvx3;
    EXPECT_EQ(ignored(kNative, {lists, treelets, "engine.simd=" + std::string(enum_name(target))}).empty(), wide)
        << enum_name(target);
  }
  std::vector<std::string> prices{"energy.profile=n45", "energy.simple_instruction=3", "energy.shade=3"};
  EXPECT_THAT(ignored(kTerrain, prices), ElementsAre("energy.simple_instruction"));
  prices.emplace_back("shading.program=built_in");
  EXPECT_THAT(ignored(kTerrain, prices), ElementsAre("energy.shade"));
}

// All pools are one there, links and routers have no time, and latencies still choose the ways of packets, if there is
// more than one.
TEST_F(IgnoredKeys, OfADrawingInTheNativeEngine) {
  const auto drawing = [&](const std::string& ring, const std::string& more = "") {
    program_.write(
        "drawn.yaml",
        "scene: {builtin: terrain, triangles: 300}\nimage: {width: 16, height: 12}\n"
        "engine: {kind: native, threads: 1}\nclocks: {slow: 500, noc: 900, synchroniser_cycles: 3}\n"
        "shading: {workers: 3}\ntopology:\n  shape: graph\n" +
            more +
            "  nodes:\n    - {name: r, count: 4}\n"
            "    - {name: x, kind: router, latency_cycles: 2, credit_cycles: 1, claim_cycles: 1, forward: whole, "
            "clock: slow}\n"
            "    - {name: s, kind: shading, serves: 'r[0..1]', workers: 2}\n    - {name: t, kind: shading}\n"
            "  links:\n    - {" +
            ring +
            ", latency_cycles: 9, bytes_per_cycle: 8, clock: slow}\n"
            "    - {from: 'r[*]', all_to: 's, t', both: true, carries: [completed_rays], latency_cycles: 5}\n");
    std::vector<std::string> out;
    for (const IgnoredKey& one :
         app::prepare({(program_.folder() / "drawn.yaml").string(), {}}, {.force = true}, false).ignored())
      out.push_back(one.key);
    return out;
  };
  std::vector<std::string> expected{"clocks.noc",
                                    "clocks.slow",
                                    "clocks.synchroniser_cycles",
                                    "topology.links.0.bytes_per_cycle",
                                    "topology.links.0.clock",
                                    "topology.links.0.latency_cycles",
                                    "topology.links.1.latency_cycles",
                                    "topology.nodes.1.claim_cycles",
                                    "topology.nodes.1.clock",
                                    "topology.nodes.1.credit_cycles",
                                    "topology.nodes.1.forward",
                                    "topology.nodes.1.latency_cycles",
                                    "topology.nodes.2.serves",
                                    "topology.nodes.2.workers"};
  EXPECT_EQ(drawing("ring: 'r[*], x'"), expected);
  // With a chord, the way from r[3] to r[0] depends on how long the links are.
  const std::string chord = "ring: 'r[*], x', latency_cycles: 9}\n    - {from: 'r[3]', to: 'r[0]'";
  const auto diameter = [&](const std::string& links) {
    drawing(links);
    return KeyOutcome::Json::parse(program_.run({"check", "drawn.yaml", "--json"}).out)["graph"]["diameter"];
  };
  const std::vector<std::string> named = drawing(chord);
  EXPECT_THAT(named, testing::Not(testing::Contains("topology.links.0.latency_cycles")));
  EXPECT_THAT(named, testing::Contains("topology.links.2.latency_cycles"));
  EXPECT_NE(diameter(chord), diameter("ring: 'r[*], x', latency_cycles: 1}\n    - {from: 'r[3]', to: 'r[0]'"));
  // Where all links have one latency, its number chooses none.
  EXPECT_THAT(drawing("ring: 'r[*], x', both: true"), testing::Contains("topology.links.0.latency_cycles"));
  EXPECT_THAT(drawing("ring: 'r[*], x'", "  tour: nearest\n"),
              testing::Not(testing::Contains("topology.nodes.1.latency_cycles")));
  // Workers that each pool names are all workers.
  drawing("ring: 'r[*], x'");
  const auto workers = [&](int of_t) {
    const std::vector<std::string> sets{"shading.workers=auto", "topology.nodes.3.workers=" + std::to_string(of_t)};
    std::vector<std::string> words{"run", "drawn.yaml", "--json", "--force"};
    add_sets(words, sets);
    const KeyOutcome::Json report = KeyOutcome::Json::parse(program_.run(words).out);
    EXPECT_THAT(report["ignored_keys"].get<std::vector<std::string>>(),
                testing::Not(testing::Contains("topology.nodes.3.workers")));
    return report["shading"]["workers"];
  };
  EXPECT_EQ(workers(1), 3);
  EXPECT_EQ(workers(4), 6);
}

TEST_F(IgnoredKeys, OfAResolvedConfigurationAreNotItsDefaults) {
  program_.write("resolved.yaml",
                 resolved_yaml(app::prepare(arguments(kTerrain, {"topology.rings=3"}), {}, false).config()));
  const auto keys_of = [&](std::vector<std::string> sets) {
    std::vector<std::string> out;
    for (const IgnoredKey& one :
         app::prepare({(program_.folder() / "resolved.yaml").string(), std::move(sets)}, {}, false).ignored())
      out.push_back(one.key);
    return out;
  };
  EXPECT_THAT(keys_of({}), ElementsAre("topology.rings"));
  EXPECT_THAT(keys_of({"topology.groups=4"}), ElementsAre("topology.groups", "topology.rings"));
}

TEST_F(IgnoredKeys, AreNamedByCheckAndRunAndInTheReport) {
  program_.write("machine.yaml", text(kTerrain));
  const std::vector<std::string> sets{"machine.yaml", "--set", "topology.rings=3"};
  const auto command = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, sets.begin(), sets.end());
    return program_.run(words);
  };
  const std::string named = "topology.rings (the topology is no multi_ring)";
  EXPECT_THAT(command({"check"}).out, HasSubstr("# ignored: " + named + "\n"));
  const Outcome run = command({"run", "--out", "out", "--json"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.err, HasSubstr("this machine ignores " + named));
  EXPECT_EQ(KeyOutcome::Json::parse(run.out)["ignored_keys"], KeyOutcome::Json({"topology.rings"}));
  for (const char* name : {"check", "run"}) {
    const Outcome strict = command({name, "--strict"});
    EXPECT_EQ(strict.status, 2) << name;
    EXPECT_THAT(strict.err, HasSubstr("topology.rings: the machine cannot feel this key")) << name;
  }
  EXPECT_EQ(program_.run({"check", "machine.yaml", "--strict"}).status, 0);
}

}  // namespace
}  // namespace carousel::ignored_keys_test

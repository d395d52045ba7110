// Plugins: what they bring is known by name everywhere, and each way in which one can be wrong is told.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::plugins_run_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

const char* const kMachine =
    "scene: {builtin: cornell}\nimage: {width: 16, height: 12}\ntopology: {resources: 4}\n"
    "rays: {slots_per_resource: 64}\npackets: {rays: 8}\n";

std::string plugin(const std::string& name) {
  return std::string(CAROUSEL_PLUGINS) + "/lib" + name + ".so";
}
std::string all_plugins() {
  return "engine.plugins=[" + plugin("own_queue") + ", " + plugin("own_policy") + ", " + plugin("own_placement") +
         ", " + plugin("own_workload") + ", " + plugin("own_prefetcher") + ", " + plugin("own_router") + ", " +
         plugin("own_dispatch") + "]";
}

class Plugins : public testing::Test {
 protected:
  Plugins() { program_.write("a.yaml", kMachine); }

  Outcome run(std::vector<std::string> sets, const std::string& command = "run") {
    std::vector<std::string> arguments{command, "a.yaml"};
    if (command == "run") arguments.insert(arguments.end(), {"--json", "--force"});
    for (std::string& set : sets) arguments.insert(arguments.end(), {"--set", std::move(set)});
    return program_.run(arguments);
  }
  Json report(const std::vector<std::string>& sets) {
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? Json::parse(outcome.out) : Json();
  }
  /// The message of a run that is refused.
  std::string refusal(const std::vector<std::string>& sets) {
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  }
  std::string fault(const char* name, std::vector<std::string> sets = {}) {
    setenv("CAROUSEL_TEST_FAULT", name, 1);
    sets.insert(sets.begin(), "engine.plugins=[" + plugin("faulty") + "]");
    const std::string message = refusal(sets);
    unsetenv("CAROUSEL_TEST_FAULT");
    return message;
  }

  Program program_;
};

TEST_F(Plugins, GiveTheSameHits) {
  const Json expected = report({})["digest"];
  const std::vector<std::string> sets{all_plugins(), "topology.link.queue=fast_forward",
                                      "collections.policy=broad_first", "rays.placement=octants"};
  for (const char* threads : {"1", "4"}) {
    std::vector<std::string> native = sets;
    native.push_back(std::string("engine.threads=") + threads);
    const Json own = report(native);
    EXPECT_EQ(own["digest"], expected);
    EXPECT_EQ(own["links"][0]["queue"], "fast_forward");
    EXPECT_EQ(own["config"]["collections"]["policy"], "broad_first");
  }
  const Json cycles = report({all_plugins(), "engine.kind=cycle", "engine.what_if=false"});
  for (const char* set : {"collections.policy=broad_first", "rays.placement=octants"}) {
    const Json own = report({all_plugins(), set, "engine.kind=cycle", "engine.what_if=false"});
    EXPECT_EQ(own["digest"], expected);
    EXPECT_NE(own["engine"]["cycles"], cycles["engine"]["cycles"]) << set;
  }
  for (const char* more :
       {"collections.home=local", "topology.shape=independent", "bundles.size=8", "rays.slots_per_resource=8"}) {
    const Json own =
        report({all_plugins(), "rays.placement=octants", "engine.kind=cycle", "engine.what_if=false", more});
    EXPECT_EQ(own["digest"], expected) << more;
  }
}

TEST_F(Plugins, AreFoundBesideTheConfiguration) {
  fs::create_directory(program_.folder() / "machines");
  fs::copy_file(plugin("own_policy"), program_.folder() / "machines" / "mine.so");
  program_.write("machines/b.yaml",
                 std::string(kMachine) + "engine: {plugins: [mine.so]}\ncollections: {policy: broad_first}\n");
  const Outcome outcome = program_.run({"run", "machines/b.yaml", "--json", "--out", "b"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json report = Json::parse(outcome.out);
  ASSERT_EQ(report["plugins"].size(), 1u);
  const Json& own = report["plugins"][0];
  const std::string file = fs::canonical(program_.folder() / "machines" / "mine.so").string();
  EXPECT_EQ(own["file"], file);
  EXPECT_EQ(own["name"], "broad policy");
  EXPECT_EQ(own["version"], "1.0");
  EXPECT_EQ(own["digest"].get<std::string>().size(), 32u);
  EXPECT_EQ(own["brings"], Json::array({"policy broad_first"}));
  EXPECT_EQ(report["config"]["engine"]["plugins"], Json::array({file}));
  // The resolved configuration runs again, from anywhere.
  const Outcome again = program_.run({"run", "b/config.resolved.yaml", "--json", "--out", "c"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["digest"], report["digest"]);
  // Reports are read without the plugin.
  fs::remove(program_.folder() / "machines" / "mine.so");
  EXPECT_EQ(program_.run({"compare", "b", "c"}).status, 0);
  EXPECT_EQ(program_.run({"report", "b"}).status, 0);
}

TEST_F(Plugins, AWorkloadTakesItsOptions) {
  const std::string workload = "workload={plugin: scanner, options: {beams: 500}}";
  const Json native = report({all_plugins(), workload});
  EXPECT_EQ(native["rays"]["by_kind"]["camera"], 500);
  EXPECT_EQ(native["rays"]["lost"], 0);
  const Json cycles = report({all_plugins(), workload, "engine.kind=cycle", "verify=reference"});
  EXPECT_EQ(cycles["digest"], native["digest"]);
  EXPECT_EQ(cycles["verify"]["mismatches"], 0);
  EXPECT_EQ(report({all_plugins(), "workload={plugin: scanner}"})["config"]["workload"]["options"]["beams"], 2000);
  EXPECT_THAT(refusal({all_plugins(), "workload={plugin: scaner}"}),
              HasSubstr("workload.plugin: expected one of scanner, found 'scaner'; did you mean 'scanner'?"));
  EXPECT_THAT(refusal({all_plugins(), "workload={plugin: scanner, options: {beam: 3}}"}),
              HasSubstr("workload.options.beam: unknown key; did you mean 'beams'?"));
  EXPECT_THAT(refusal({all_plugins(), "workload={plugin: scanner, options: {beams: 0}}"}),
              HasSubstr("workload.options.beams: expected a number from 1 to 1e+06 (beams), found 0"));
  EXPECT_THAT(refusal({"workload={plugin: scanner}"}),
              HasSubstr("workload.plugin: expected a name that one of engine.plugins brings; they bring none"));
  EXPECT_THAT(refusal({all_plugins(), workload, "sampling.fraction=0.5"}), HasSubstr("sampling.fraction: "));
}

// A part with a clock: its look-ups take cycles, its requests go over the machine's wires, and its table costs area.
TEST_F(Plugins, APrefetcherHasAClockAWireAndAnArea) {
  const std::vector<std::string> machine{"scene={builtin: terrain, triangles: 2000}",
                                         "engine.kind=cycle",
                                         "engine.what_if=false",
                                         "memory.shape_buffer_kib=1",
                                         "memory.l2_kib=4",
                                         "energy.profile=n45",
                                         all_plugins()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), machine.begin(), machine.end());
    return report(more);
  };
  const Json without = with({}), own = with({"prefetcher={lines: 2, rule: pairs}", "engine.threads=1"});
  EXPECT_EQ(own["digest"], without["digest"]);
  EXPECT_NE(own["engine"]["cycles"], without["engine"]["cycles"]);
  EXPECT_EQ(own["config"]["prefetcher"]["rule"], "pairs");
  const Json& counts = own["prefetcher"];
  EXPECT_GT(counts["lines"], 0);
  EXPECT_GT(counts["met"], 0);
  EXPECT_LE(counts["met"], counts["lines"]);
  EXPECT_EQ(counts["streams"], 0);
  // 64 entries of 16 bytes for each of four streams at the one L2; six words a hint.
  EXPECT_NEAR(own["area"]["parts"]["prefetcher"]["mm2"].get<double>(), 4 * 0.00456, 1e-6);  // KiB by n45
  EXPECT_EQ(own["energy"]["parts"]["prefetcher"]["events"].get<double>(), 6 * counts["hints"].get<double>());
  // The same cycles on any number of threads, and others than the program's own rule.
  EXPECT_EQ(with({"prefetcher={lines: 2, rule: pairs}", "engine.threads=3"})["engine"]["cycles"],
            own["engine"]["cycles"]);
  EXPECT_NE(with({"prefetcher={lines: 2}"})["prefetcher"], counts);
  EXPECT_THAT(refusal({all_plugins(), "engine.kind=cycle", "prefetcher={lines: 2, rule: pears}"}),
              HasSubstr("prefetcher.rule: expected one of strides, pairs, found 'pears'; did you mean 'pairs'?"));
}

TEST_F(Plugins, APrefetcherThatBreaksItsContractEndsTheRun) {
  const auto message = [&](const char* fault) {
    setenv("CAROUSEL_TEST_FAULT", fault, 1);
    const Outcome outcome = run({"engine.plugins=[" + plugin("faulty") + "]", "engine.kind=cycle",
                                 "engine.what_if=false", "prefetcher={lines: 4, rule: breaker}"});
    unsetenv("CAROUSEL_TEST_FAULT");
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(message("greedy"), HasSubstr("prefetcher.rule: breaker asks for more than prefetcher.lines, 4, at once"));
  EXPECT_THAT(message("nowhere"), HasSubstr("prefetcher.rule: breaker asks for line 18446744073709551615, which"));
  EXPECT_THAT(message("late"), HasSubstr("prefetcher.rule: breaker wants cycle "));
  EXPECT_THAT(message("no prefetcher"), HasSubstr("prefetcher.rule: breaker makes none"));
}

// A router's answers are the tables of the network: check, verdict and both engines have its ways.
TEST_F(Plugins, ARouterFindsTheWays) {
  const std::vector<std::string> mesh{all_plugins(),
                                      "engine.what_if=false",
                                      "topology.visit=owners",
                                      "topology.shape=graph",
                                      "topology.resources=9",
                                      "topology.nodes=[{name: r, count: 9, at: [0, 0], step: [2, 2], columns: 3}]",
                                      "topology.links=[{mesh: [3, 3], of: 'r[*]'}]"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), mesh.begin(), mesh.end());
    return more;
  };
  const Json shortest = report(with({"engine.kind=cycle"})),
             own = report(with({"engine.kind=cycle", "topology.routes=columns_first"}));
  EXPECT_EQ(own["digest"], shortest["digest"]);
  EXPECT_NE(own["engine"]["cycles"], shortest["engine"]["cycles"]);
  EXPECT_EQ(own["config"]["topology"]["routes"], "columns_first");
  EXPECT_EQ(report(with({"engine.kind=native", "topology.routes=columns_first"}))["digest"], own["digest"]);
  // No way turns from a row into a column, so links that wait for one another form no circle.
  const Outcome check = run(
      with({"engine.kind=cycle", "workload={traffic: {rate: 0.1, packets: 2000}}", "topology.routes=columns_first"}),
      "check");
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("no circle: the links of all ways can be put in an order"));
  EXPECT_THAT(refusal(with({"topology.routes=column_first"})), HasSubstr("did you mean 'columns_first'?"));
}

TEST_F(Plugins, ARouterWhoseWaysDoNotEndIsRefused) {
  const std::vector<std::string> line{"engine.kind=cycle",    "topology.visit=owners",
                                      "topology.shape=graph", "topology.nodes=[{name: r, count: 4}]",
                                      "topology.routes=lost", "topology.links=[{line: 'r[*]', both: true}]"};
  EXPECT_THAT(fault("circles", line), HasSubstr("topology.routes: lost sends packets from r["));
  EXPECT_THAT(fault("nowhere", line), HasSubstr("topology.links: there is no way of lost from r[0] to r[1]"));
}

TEST_F(Plugins, ADispatchChoosesAmongPacketsThatWait) {
  const std::vector<std::string> machine{"scene={builtin: terrain, triangles: 2000}", "engine.kind=cycle",
                                         "engine.what_if=false", "testers={window: 4, contexts: 2}", all_plugins()};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), machine.begin(), machine.end());
    return report(more);
  };
  const char* const kFullest = "testers.dispatch=fullest_first";
  const Json ready = with({}), own = with({kFullest, "engine.threads=1"});
  EXPECT_EQ(own["digest"], ready["digest"]);
  EXPECT_NE(own["engine"]["cycles"], ready["engine"]["cycles"]);
  EXPECT_EQ(own["config"]["testers"]["dispatch"], "fullest_first");
  EXPECT_EQ(with({kFullest, "engine.threads=3"})["engine"]["cycles"], own["engine"]["cycles"]);
  // On a bus others hear a packet that its owner may be issuing anew: the rule does not see into it.
  const auto bus = [&](const char* threads) { return with({"topology.shape=bus", kFullest, threads}); };
  EXPECT_EQ(bus("engine.threads=3")["engine"]["cycles"], bus("engine.threads=1")["engine"]["cycles"]);
  for (const char* fault : {"hasty", "none"}) {
    setenv("CAROUSEL_TEST_FAULT", fault, 1);
    const Outcome outcome = run({"engine.plugins=[" + plugin("faulty") + "]", "engine.kind=cycle",
                                 "engine.what_if=false", "testers={window: 4, contexts: 1, dispatch: hasty}"});
    unsetenv("CAROUSEL_TEST_FAULT");
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("testers.dispatch: hasty chose packet "));
  }
}

TEST_F(Plugins, NamesAreKnownToMessagesAndSchema) {
  EXPECT_THAT(refusal({all_plugins(), "collections.policy=broad_frist"}),
              HasSubstr("found 'broad_frist'; did you mean 'broad_first'?"));
  EXPECT_THAT(refusal({all_plugins(), "topology.link.queue=fast_forward", "engine.kind=cycle"}),
              HasSubstr("topology.link.queue: the cycle engine has no real queues"));
  // A name counts where its plugin is named, and nowhere else.
  EXPECT_THAT(refusal({"collections.policy=broad_first"}),
              HasSubstr("collections.policy: expected one of fullest, oldest, newest, deepest, nearest, found"));
  EXPECT_THAT(refusal({all_plugins(), "rays.queue=fast_forward", "engine.threads=4", "shading.queue=fast_forward"}),
              HasSubstr("fast_forward is made for one producer at a time and here are several"));

  const Outcome schema =
      program_.run({"schema", "config", "--plugin", plugin("own_queue"), "--plugin", plugin("own_workload"), "--plugin",
                    plugin("own_placement"), "--plugin", plugin("own_prefetcher"), "--plugin", plugin("own_router"),
                    "--plugin", plugin("own_dispatch")});
  ASSERT_EQ(schema.status, 0) << schema.err;
  const Json json = Json::parse(schema.out)["properties"];
  const Json& queues = json["topology"]["properties"]["link"]["properties"]["queue"]["enum"];
  EXPECT_EQ(queues.back(), "fast_forward");
  EXPECT_EQ(json["shading"]["properties"]["queue"]["enum"], queues);
  EXPECT_EQ(json["rays"]["properties"]["placement"]["enum"].back(), "octants");
  EXPECT_EQ(json["topology"]["properties"]["routes"]["enum"].back(), "columns_first");
  EXPECT_EQ(json["testers"]["properties"]["dispatch"]["enum"], Json::array({"ready", "fullest_first"}));
  EXPECT_EQ(json["prefetcher"]["properties"]["rule"]["enum"], Json::array({"strides", "pairs"}));
  EXPECT_THAT(json["workload"].dump(), HasSubstr(R"("beams":{"type":"number","minimum":1.0,"maximum":1000000.0)"));
  EXPECT_EQ(program_.run({"schema", "config", "--plugin", "nowhere.so"}).status, 2);
}

TEST_F(Plugins, QueuesGoIntoTheLaboratory) {
  const Outcome alone =
      program_.run({"stress", "--plugin", plugin("own_queue"), "--queue", "fast_forward,mutex", "--pattern",
                    "stream,burst,capacity_1", "--messages", "2000", "--seconds", "1", "--repetitions", "1", "--json"});
  ASSERT_EQ(alone.status, 0) << alone.err;
  EXPECT_EQ(Json::parse(alone.out)["rows"][0]["queue"], "fast_forward");
  const Outcome ring =
      program_.run({"stress",        "a.yaml", "--set",      all_plugins(), "--queue",   "fast_forward,spsc_ring",
                    "--pattern",     "stream", "--messages", "1000",        "--seconds", "1",
                    "--repetitions", "1",      "--pairs",    "0",           "--depths",  "4",
                    "--json",        "--out",  "ring"});
  ASSERT_EQ(ring.status, 0) << ring.err;
  EXPECT_THAT(ring.out, HasSubstr("\"queue\": \"fast_forward\""));
  const Outcome wrong = program_.run({"stress", "--plugin", plugin("own_queue"), "--queue", "fast_foward"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean fast_forward?"));
}

TEST_F(Plugins, ASweepKnowsTheNamesAndTheContents) {
  fs::copy_file(plugin("own_policy"), program_.folder() / "mine.so");
  program_.write("s.yaml", std::string(kMachine) +
                               "engine: {plugins: [mine.so], kind: cycle, what_if: false}\nvary: {collections.policy: "
                               "[oldest, broad_first]}\n");
  const Outcome first = program_.run({"sweep", "s.yaml", "--out", "s"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(program_.read("s/sweep.csv"), HasSubstr("broad_first"));
  const Outcome again = program_.run({"sweep", "s.yaml", "--out", "s", "--dry-run"});
  EXPECT_THAT(again.out + again.err, HasSubstr("2 done"));
  // Another plugin of the same names is another machine.
  std::ofstream(program_.folder() / "mine.so", std::ios::binary | std::ios::app) << "changed";
  const Outcome changed = program_.run({"sweep", "s.yaml", "--out", "s", "--dry-run"});
  EXPECT_EQ((changed.out + changed.err).find("2 done"), std::string::npos) << changed.out;
}

TEST_F(Plugins, WhatIsNoPluginIsRefused) {
  program_.write("a.yaml", std::string(kMachine) + "engine:\n  plugins: [nowhere.so]\n");
  EXPECT_THAT(refusal({}), HasSubstr("a.yaml:7:13: engine.plugins.0: expected a plugin beside the configuration or in "
                                     "the working directory, found 'nowhere.so', which is not there"));
  program_.write("a.yaml", kMachine);
  program_.write("text.so", "no library");
  EXPECT_THAT(refusal({"engine.plugins=[text.so]"}),
              HasSubstr("text.so cannot be opened: it is no plugin of Carousel"));
  EXPECT_THAT(refusal({"engine.plugins=[.]"}), HasSubstr("cannot be opened: it is no file"));
  EXPECT_THAT(refusal({"engine.plugins=text.so"}), HasSubstr("engine.plugins: expected a list, found 'text.so'"));
  EXPECT_THAT(refusal({std::string("engine.plugins=[") + CAROUSEL_PROBE + "]"}),
              HasSubstr("it does not export carousel_plugin"));
  EXPECT_THAT(refusal({std::string("engine.plugins=[") + CAROUSEL_STRANGER + "]"}),
              HasSubstr("it is of the build 0.0.1 stranger; expected that of this program, "));
  EXPECT_THAT(
      refusal({"engine.plugins=[" + plugin("own_policy") + ", " + plugin("own_policy") + "]"}),
      HasSubstr("engine.plugins.1: the plugin " + fs::canonical(plugin("own_policy")).string() + " is named twice"));
  // A file that is cut off has the words of a plugin and is none.
  std::ifstream in(plugin("own_queue"), std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  bytes.replace(0, 4, "junk");
  std::ofstream(program_.folder() / "cut.so", std::ios::binary) << bytes;
  EXPECT_THAT(refusal({"engine.plugins=[cut.so]"}), HasSubstr("cut.so cannot be opened: "));
}

TEST_F(Plugins, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(fault("compiler"), HasSubstr("it is compiled by compiler 1.0; expected compiler "));
  EXPECT_THAT(fault("no description"), HasSubstr("it does not tell its build"));
  EXPECT_THAT(fault("nameless"), HasSubstr("it does not tell name, version and what it brings"));
  EXPECT_THAT(fault("nothing"), HasSubstr("it brings nothing"));
  EXPECT_THAT(fault("throws"), HasSubstr("it gives up: no licence"));
  EXPECT_THAT(fault("null"), HasSubstr("it brings nothing as policy lazy"));
  EXPECT_THAT(fault("twice"), HasSubstr("it brings two of policy lazy"));
  EXPECT_THAT(fault("taken"), HasSubstr("it brings a policy of the name oldest, which the program has"));
  EXPECT_THAT(fault("badly named"), HasSubstr("it calls a policy 'My Policy'; expected at most 64 of a-z, 0-9 and _"));
  EXPECT_THAT(fault("another's", {"engine.plugins.1=" + plugin("own_policy")}),
              HasSubstr("brings a policy of the name broad_first, which "));
  EXPECT_THAT(fault("no workload", {"workload={plugin: liar}"}),
              HasSubstr("workload.plugin: liar gives up: there are no beams today"));
}

TEST_F(Plugins, WhatAPluginDoesWrongEndsTheRun) {
  const std::string faulty = "engine.plugins=[" + plugin("faulty") + "]";
  for (const char* engine : {"engine.kind=native", "engine.kind=cycle"}) {
    const Outcome beyond = run({faulty, "rays.placement=beyond", engine});
    EXPECT_EQ(beyond.status, 1) << beyond.err;
    EXPECT_THAT(beyond.err, HasSubstr("rays.placement: beyond chose resource 4 of 4"));
    const Outcome liar = run({faulty, "workload={plugin: liar}", engine});
    EXPECT_EQ(liar.status, 1) << liar.err;
    EXPECT_THAT(liar.err, HasSubstr("the plugin's workload says that it made 1 rays of at most "));
  }
}

}  // namespace
}  // namespace carousel::plugins_run_test

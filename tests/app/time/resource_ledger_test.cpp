// Every cycle of every bank of units is accounted to one thing, also where a bank's interval is longer than its
// latency.
#include <random>

#include <fmt/format.h>

#include "core/types/unit_kind.h"
#include "tests/app/time/timed_run.h"
#include "tests/support/random_runs.h"

namespace carousel::resource_ledger_test {
namespace {

class ResourceLedger : public TimedRun {
 protected:
  void expect_sums(const Json& report) {
    const std::uint64_t cycles = report["engine"]["cycles"];
    for (const Json& resource : report["resources"]) {
      for (const auto& [bank, parts] : resource["units"].items()) {
        if (!parts.is_object() || !parts.contains("busy")) continue;
        std::uint64_t sum = 0;
        for (const auto& [name, part] : parts.items()) {
          EXPECT_LE(part.get<std::uint64_t>(), cycles) << bank << " " << name;
          sum += part.get<std::uint64_t>();
        }
        EXPECT_EQ(sum, cycles) << bank;
      }
      EXPECT_EQ(resource["units"]["dispatch_busy"].get<std::uint64_t>() +
                    resource["units"]["dispatch_idle"].get<std::uint64_t>(),
                cycles);
    }
    for (const Json& link : report["links"]) {
      std::uint64_t sum = 0;
      for (const auto& [name, part] : link["cycles"].items()) sum += part.get<std::uint64_t>();
      EXPECT_EQ(sum, cycles);
    }
  }
};

constexpr const char* kSmall =
    "scene: {builtin: instances, instances: 60}\n"
    "image: {width: 6, height: 4, samples: 1, max_depth: 3}\n"
    "topology: {resources: 2}\n"
    "packets: {rays: 8}\n"
    "collections: {ready: 8}\n"
    "rays: {slots_per_resource: 32}\n";

TEST_F(ResourceLedger, AnIntervalLongerThanTheLatencyIsNoUnderflow) {
  const Json run = report(kSmall, {"testers.triangle={units: 1, interval_cycles: 40, latency_cycles: 1}",
                                   "testers.box={units: 1, interval_cycles: 9, latency_cycles: 2}"});
  expect_sums(run);
  // A triangle's unit is kept from the next test while there is nothing else to do.
  // One that is met takes four passes more, for its distance in 64 bits.
  std::uint64_t busy = 0, tests = 4 * run["tests"]["refined"]["count"].get<std::uint64_t>();
  for (const Json& resource : run["resources"]) {
    busy += resource["units"]["triangle"]["busy"].get<std::uint64_t>();
    tests += resource["triangle_tests"].get<std::uint64_t>();
  }
  EXPECT_LE(busy, 40 * tests);
  EXPECT_GE(busy + 2 * 40, 40 * tests);  // but for an interval that the run's end cuts off at either resource
}

TEST_F(ResourceLedger, PartsAddUpOnRandomMachines) {
  std::mt19937 random(run_seed());
  const auto pick = [&](auto... values) {
    const std::vector<std::string> all{fmt::format("{}", values)...};
    return all[random() % all.size()];
  };
  for (int run = 0; run < scaled(24); ++run) {
    std::vector<std::string> sets{
        "topology.shape=" + pick("ring", "bidirectional", "bus", "independent"),
        "topology.visit=" + pick("all", "owners"),
        "topology.resources=" + pick(1, 2, 3),
        "topology.link.latency_cycles=" + pick(1, 4, 60),
        "testers.contexts=" + pick(1, 2, 4),
        "rays.reads_per_cycle=" + pick(0, 1),
        "collections.traversal=" + pick("spread", "ordered", "treelet"),
        "memory.dram_latency_cycles=" + pick(2, 200),
        "shading.idle_resources_shade=" + pick("false", "true"),
    };
    for (const UnitKindRow& row : kUnitKinds)
      sets.push_back(fmt::format("testers.{}={{units: {}, interval_cycles: {}, latency_cycles: {}}}", row.key,
                                 pick(1, 3), pick(1, 2, 17), pick(1, 5)));
    SCOPED_TRACE(fmt::format("seed {}, run {}: {}", run_seed(), run, fmt::join(sets, " ")));
    expect_sums(report(kSmall, sets));
  }
}

// A machine with one kind of test and one ray at a time: while its pipeline works nothing else does. A slower pipeline
// costs as much time as it takes longer, and all of it is told as latency.
TEST_F(ResourceLedger, APipelineThatIsWaitedForIsToldSo) {
  const auto run = [&](const char* latency) {
    const Json all =
        report(kSmall, {"topology={shape: independent, resources: 1}", "rays.slots_per_resource=1", "image.max_depth=1",
                        "image.width=2", "image.height=1",
                        fmt::format("testers.box={{units: 8, interval_cycles: 1, latency_cycles: {}}}", latency)});
    expect_sums(all);
    return std::pair(all["engine"]["cycles"].get<std::int64_t>(), all["resources"][0]["units"]["box"]);
  };
  const auto [cycles, box] = run("3");
  const auto [slow_cycles, slow_box] = run("43");
  ASSERT_GT(slow_cycles, cycles);
  EXPECT_EQ(slow_box["latency"].get<std::int64_t>() - box["latency"].get<std::int64_t>(), slow_cycles - cycles);
  EXPECT_EQ(slow_box["busy"], box["busy"]);
  EXPECT_EQ(slow_box["other_units"], box["other_units"]);
}

// Two units of which a lone ray's one box takes one: half of the places are empty.
TEST_F(ResourceLedger, TellsHowManyUnitsOfAKindAreFilled) {
  const auto fill = [&](const char* units) {
    const Json all = report(kSmall, {"topology={shape: independent, resources: 1}", "rays.slots_per_resource=1",
                                     fmt::format("testers.triangle.units={}", units)});
    return all["resources"][0]["units"]["unit_fill"]["triangle"].get<double>();
  };
  EXPECT_EQ(fill("1"), 1);
  EXPECT_LT(fill("64"), 0.5);
  EXPECT_GT(fill("64"), 0);
}

// Links that are late now and then make packets wait for credits. A resource with none of the rays and no packets of
// its own has nothing else to wait for, so it is in the state `link` for just as long, whether or not anything happens
// when a wait begins.
TEST_F(ResourceLedger, AResourceThatOnlyPassesPacketsOnWaitsForLinksWhileItsLinkIsStalled) {
  std::uint64_t waited = 0;
  for (const char* pixels : {"2", "3", "16"})
    for (const char* visit : {"all", "owners"})
      for (const char* late : {"30", "150", "200"}) {
        SCOPED_TRACE(fmt::format("{} pixels, visit: {}, {} cycles late", pixels, visit, late));
        const Json run = report(
            "scene: {builtin: terrain, triangles: 2000}\n"
            "image: {height: 1, samples: 1, max_depth: 1}\n"
            "topology: {shape: ring, resources: 5, link: {depth: 1, bytes_per_cycle: 8}}\n"
            "collections: {traversal: spread}\n",
            {fmt::format("image.width={}", pixels), fmt::format("topology.visit={}", visit),
             fmt::format("faults.links={{delay: 0.3, delay_cycles: {}}}", late)});
        for (std::size_t r = 0; r < run["resources"].size(); ++r) {
          const Json& bank = run["resources"][r]["units"]["triangle"];
          if (run["resources"][r]["packets_issued"] != 0 || bank["busy"] != 0 || bank["other_units"] != 0 ||
              bank["memory"] != 0)
            continue;
          EXPECT_EQ(bank["link"], run["links"][r]["cycles"]["stalled"]) << "resource " << r;
          waited += bank["link"].get<std::uint64_t>();
        }
      }
  EXPECT_GT(waited, 0u);
}

}  // namespace
}  // namespace carousel::resource_ledger_test

// Joules and square millimetres, computed a second time from the counters of the report and from numbers that stand
// here, on machines that are read from text as `carousel run` reads them.
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/costs/cost_table.h"
#include "tests/app/support/program.h"

namespace carousel::energy_test {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMachine =
    "scene: {{builtin: cornell}}\n"
    "image: {{width: 12, height: 8, samples: 1, max_depth: 2}}\n"
    "engine: {{kind: cycle, clock_mhz: 1000}}\n"
    "topology: {{resources: 8, shape: {}}}\n"
    "rays: {{slots_per_resource: 512}}\n"
    "collections: {{capacity: 8192}}\n"
    "memory: {{shape_buffer_kib: 8, l2_kib: 1024}}\n"
    "energy: {{profile: {}}}\n"
    "area: {{link_mm: 2}}\n";

class EnergyRun : public testing::Test {
 protected:
  Json run(const std::string& shape, const std::vector<std::string>& sets = {}, const std::string& profile = "n45") {
    program_.write("machine.yaml", fmt::format(kMachine, shape, profile));
    std::vector<std::string> arguments{"run", "machine.yaml", "--out", "out", "--force", "--quiet"};
    add_sets(arguments, sets);
    const Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.status == 0 ? Json::parse(program_.read("out/report.json")) : Json();
  }
  Program program_;
};

double bytes_over(const Json& report, const std::string& wire) {
  double out = 0;
  for (const Json& row : report["bytes"])
    if (row["over"] == wire) out += row["bytes"].get<double>();
  return out;
}

double bytes_of(const Json& report, const std::string& what) {
  for (const Json& row : report["bytes"])
    if (row["what"] == what) return row["bytes"].get<double>();
  return 0;
}

/// Picojoules by the profile n45, with links of 2 mm. `link_lengths` is the mean length of a packet's link, in links.
double expected_pj(const Json& r, double link_lengths) {
  const auto count = [&](const char* test) {
    return r["tests"].contains(test) ? r["tests"][test]["count"].get<double>() : 0.0;
  };
  double pj = 28.6 * count("box") + 116.8 * count("triangle") + 80.1 * count("transforms");
  pj += 563.19 * count("refined");  // tests/app/run/method_prices_test.cpp
  const double new_rays = bytes_of(r, "new rays"), completed = bytes_of(r, "completed rays");
  const double at_store = 20 * (8 * count("ray_reads") + (new_rays + completed) / 8);  // 32 KiB
  pj += at_store;
  if (r.contains("packets")) {
    const double ids = r["packets"]["issued"].get<double>() * r["packets"]["rays_mean"].get<double>();
    pj += 20 * ids;  // 32 KiB
  }
  const Json& buffers = r["memory"]["shape_buffers"];
  const double needed =
      buffers["hits"].get<double>() + buffers["merged"].get<double>() + buffers["misses"].get<double>();
  pj += 10 * (8 * needed + bytes_of(r, "shape data") / 8);  // 8 KiB
  for (const Json& resource : r["resources"])
    if (resource.contains("stack"))
      pj +=
          20 * (resource["stack"]["pushed_bytes"].get<double>() + resource["stack"]["popped_bytes"].get<double>()) / 8;
  for (const Json& cache : r["memory"]["caches"])
    pj += 100 * 8 * (cache["lines"].get<double>() + cache["misses"].get<double>());  // 1 MiB, lines of 64 bytes
  const double packets = bytes_of(r, "packets");
  pj += packets * (0.45 + 0.96 * 2 * link_lengths);
  const double messages = new_rays + completed + bytes_of(r, "shape requests") + bytes_of(r, "shape data") +
                          bytes_of(r, "any-hit questions") + bytes_of(r, "any-hit answers") +
                          bytes_of(r, "shading jobs") + bytes_of(r, "notes and results");
  pj += messages * (0.45 + 0.96 * 2 * std::sqrt(8) / 2);
  pj += 244 * bytes_over(r, "DRAM's data wires");
  pj += 736 * r["shading"]["shaded"].get<double>();
  // The reciprocals of a ray's direction, when it is made and when it is brought to model space.
  pj += 3 * 18.4 * (r["shading"]["shaded"].get<double>() + count("transforms"));
  pj += 4.6 * r["shading"]["products"].get<double>() + 80 * r["shading"]["lookups"].get<double>();
  return pj;
}

TEST_F(EnergyRun, AgreesWithTheCounters) {
  for (const auto& [shape, length] : {std::pair{"ring", 1.0}, std::pair{"bidirectional", 1.0},
                                      std::pair{"independent", 0.0}, std::pair{"bus", 8.0}}) {
    SCOPED_TRACE(shape);
    const Json r = run(shape);
    ASSERT_TRUE(r.contains("energy"));
    double lengths = length;
    if (shape == std::string("bus")) {  // bytes that leave the bus have no way of their own
      double in = 0, all = 0;
      for (const Json& link : r["links"]) {
        all += link["bytes"].get<double>();
        if (link["to"] == 8) in += link["bytes"].get<double>();
      }
      ASSERT_GT(in, 0);
      lengths = 8 * in / all;
    }
    const double expected = expected_pj(r, lengths) * 1e-12;
    EXPECT_NEAR(r["energy"]["joules"].get<double>() / expected, 1, 1e-5);
    double sum = 0;
    for (const auto& [key, part] : r["energy"]["parts"].items()) sum += part["joules"].get<double>();
    EXPECT_NEAR(sum / r["energy"]["joules"].get<double>(), 1, 1e-12);
    const double rays = r["rays"]["completed"], seconds = r["engine"]["cycles"].get<double>() * 1e-9;
    EXPECT_NEAR(r["energy"]["nj_per_ray"].get<double>(), 1e9 * expected / rays, 1e-4 * 1e9 * expected / rays);
    EXPECT_NEAR(r["energy"]["watts"].get<double>() / (expected / seconds), 1, 1e-5);
    EXPECT_NEAR(r["area"]["mrays_per_second_per_mm2"].get<double>(),
                rays / seconds * 1e-6 / r["area"]["mm2"].get<double>(), 1e-6);
  }
}

TEST_F(EnergyRun, AreaIsOfTheConfiguredParts) {
  const Json r = run("ring");
  const Json& parts = r["area"]["parts"];
  // 4 box, 1 triangle and 1 transform unit; the scene is opaque, so that no any-hit unit is in use.
  EXPECT_NEAR(parts["test_units"]["mm2"].get<double>(), 8 * (4 * 0.126 + 0.193 + 0.0928), 1e-4);
  EXPECT_NEAR(parts["ray_stores"]["mm2"].get<double>(), 8 * 32 * 0.00456, 1e-4);
  EXPECT_NEAR(parts["collections"]["mm2"].get<double>(), 8 * 32 * 0.00456, 1e-4);
  EXPECT_NEAR(parts["shape_buffers"]["mm2"].get<double>(), 8 * 8 * 0.00456, 1e-4);
  EXPECT_NEAR(parts["l2"]["mm2"].get<double>(), 1024 * 0.00456, 1e-3);
  EXPECT_NEAR(parts["shaders"]["mm2"].get<double>(), 16 * 8 * 0.021, 1e-4);
  // Four lines a cycle of an L2 that serves a square of eight resources.
  EXPECT_NEAR(parts["memory_ports"]["mm2"].get<double>(), 8 * 256 * std::sqrt(8) * 0.28e-3, 1e-4);
  const double wires = parts["wires"]["mm2"];
  EXPECT_NEAR(wires, 8 * 256 * 2 * 0.28e-3, 1e-4);
  double sum = 0;
  for (const auto& [key, part] : parts.items()) sum += part["mm2"].get<double>();
  EXPECT_NEAR(sum, r["area"]["mm2"].get<double>(), 1e-9);
  const Json both = run("bidirectional");
  EXPECT_NEAR(both["area"]["parts"]["wires"]["mm2"].get<double>(), 2 * wires, 1e-9) << "twice a ring's wires";
}

// A line of an own cache is read from 16 KiB, and those that come from the L2 are written there. Its way to the
// resource is half of a side of one of 2 mm.
TEST_F(EnergyRun, OwnCachesAreReadAndWritten) {
  const Json r = run("ring", {"memory.l1_kib=16"});
  const Json &parts = r["energy"]["parts"], &own = r["memory"]["own_caches"];
  EXPECT_NEAR(parts["l1"]["events"].get<double>(), 8 * (own["lines"].get<double>() + own["misses"].get<double>()), 0.5);
  EXPECT_NEAR(parts["l1"]["pj_each"].get<double>(), 10 * std::sqrt(2), 1e-3);  // between 8 and 32 KiB
  double all = 0, near = 0, at_l2 = 0;
  for (const Json& row : r["bytes"]) {
    if (row["over"] == "links" || row["from"] == "DRAM" || row["to"] == "DRAM") continue;
    const bool l1 = row["from"] == "L1" || row["to"] == "L1", l2 = row["from"] == "L2" || row["to"] == "L2";
    (l2 ? at_l2 : l1 ? near : all) += row["bytes"].get<double>();
  }
  EXPECT_GT(near, bytes_of(r, "shape requests"));
  EXPECT_EQ(at_l2, bytes_of(r, "line requests of L1") + bytes_of(r, "lines for L1"));
  EXPECT_NEAR(parts["message_wires"]["events"].get<double>(), near + (all + at_l2) * std::sqrt(8), 1);
  EXPECT_FALSE(run("ring")["energy"]["parts"].contains("l1"));
}

// A prefetcher of 4 streams: its table, which each hint reads and writes in part, its wires, and the tags of the L2.
TEST_F(EnergyRun, APrefetcherIsNotFree) {
  const Json without = run("ring"), r = run("ring", {"prefetcher.lines=2", "memory.shared_by=4"});
  EXPECT_FALSE(without["energy"]["parts"].contains("prefetcher") || without["area"]["parts"].contains("prefetcher"));
  const Json &parts = r["energy"]["parts"], &counts = r["prefetcher"];
  EXPECT_EQ(parts["prefetcher"]["events"], 10 * counts["hints"].get<double>());
  EXPECT_GT(parts["prefetcher"]["joules"], 0);
  EXPECT_NEAR(r["area"]["parts"]["prefetcher"]["mm2"].get<double>(), 2 * 64.0 / 1024 * 0.00456, 1e-7);  // two L2s
  EXPECT_EQ(bytes_of(r, "prefetch hints"), 8 * counts["hints"].get<double>());
  EXPECT_EQ(bytes_of(r, "prefetch requests"), 16 * counts["lines"].get<double>());
  double lines = 0, asked = 0;
  for (const Json& cache : r["memory"]["caches"]) {
    asked += cache["ahead"]["asked"].get<double>();
    lines += cache["lines"].get<double>() + cache["misses"].get<double>() + cache["ahead"]["fetched"].get<double>();
  }
  EXPECT_EQ(asked, counts["lines"].get<double>());
  EXPECT_NEAR(parts["l2"]["events"].get<double>(), 8 * lines + asked, 0.5);
  const double at_l2 = bytes_of(r, "prefetch hints") + bytes_of(r, "prefetch requests") +
                       bytes_of(r, "shape requests") + bytes_of(r, "shape data");
  const double others = parts["messages"]["events"].get<double>() - at_l2;
  EXPECT_NEAR(parts["message_wires"]["events"].get<double>(), at_l2 * std::sqrt(4) + others * std::sqrt(8), 1);
}

// Each bank of a ray store has a port to the box units and one to the units for primitives.
TEST_F(EnergyRun, ASecondPortTakesItsPlace) {
  const auto stores = [&](const std::string& banks) {
    const Json r = run("ring", {"rays.banks=" + banks, "rays.reads_per_cycle=0"});
    return r["area"]["parts"]["ray_stores"]["mm2"].get<double>();
  };
  EXPECT_NEAR(stores("0"), 8 * 32 * 0.00456, 1e-4);
  EXPECT_NEAR(stores("4"), 2 * 8 * 32 * 0.00456, 1e-4);
}

// A packet of 32 IDs has 144 bytes; with a packet for each of eight boxes there are eight, and with messages one of 20
// bytes for each ray and box.
TEST_F(EnergyRun, PlacesOfQueuesHoldWhatGoesAlongWithAPacket) {
  const auto bytes = [&](const std::string& results) {
    const Json r =
        run("ring", {"packets.rays=32", "topology.link.depth=16", "bvh.width=8", "packets.results=" + results});
    return r["area"]["parts"]["link_queues"]["size"].get<double>() * 1024 / (8 * 16);
  };
  EXPECT_NEAR(bytes("mask"), 144, 1e-6);
  EXPECT_NEAR(bytes("implied_order"), 144, 1e-6);
  EXPECT_NEAR(bytes("per_shape"), 8 * 144, 1e-6);
  EXPECT_NEAR(bytes("message"), 144 + 32 * 8 * 20, 1e-6);
}

TEST_F(EnergyRun, TheCostsStandInTheReportWithTheirSources) {
  for (const std::string profile : {"n45", "n7"}) {
    const Json r = run("ring", {"energy.box=7"}, profile);
    ASSERT_EQ(r["costs"].size(), kCostTable.size());
    for (std::size_t i = 0; i < kCostTable.size(); ++i) {
      const Json& row = r["costs"][i];
      const CostValue& own = profile == "n45" ? kCostTable[i].n45 : kCostTable[i].n7;
      EXPECT_FALSE(row["source"].get<std::string>().empty());
      if (row["key"] == "energy.box") {
        EXPECT_EQ(row["value"], 7);
        EXPECT_EQ(row["basis"], "given");
      } else {
        EXPECT_FLOAT_EQ(row["value"].get<float>(), own.value) << row["key"];
      }
    }
    EXPECT_NEAR(r["energy"]["parts"]["box_tests"]["pj_each"].get<double>(), 7, 1e-9);
  }
}

// A ray is turned into each oriented box's frame, 28.6 + 80.1 pJ, and a sphere costs what a primitive that is one does.
TEST_F(EnergyRun, OtherBoundsCostWhatTheirTestsTake) {
  const auto box = [&](const std::string& set) {
    const Json r = run("ring", {set});
    const double units = r["area"]["parts"]["test_units"]["mm2"].get<double>() / 8 - (0.193 + 0.0928);
    return std::pair(r["energy"]["parts"]["box_tests"]["pj_each"].get<double>(), units / 4);
  };
  const auto turned = box("bvh.elements=oriented_boxes"), round = box("bvh.elements=spheres");
  EXPECT_NEAR(turned.first, 28.6 + 80.1, 1e-3);
  EXPECT_NEAR(turned.second, 0.126 + 0.0928, 1e-5);
  EXPECT_NEAR(round.first, 116.8, 1e-3);
  EXPECT_NEAR(round.second, 0.193, 1e-5);
  const Json r = run("ring", {"cull_planes={count: 1, object: sphere}"});
  EXPECT_NEAR(r["energy"]["parts"]["plane_tests"]["pj_each"].get<double>(), 116.8, 1e-3);
}

TEST(CostsPage, HasEveryNumberWithItsSource) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/docs/reference/costs.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  static constexpr const char* kBases[] = {"published", "derived", "assumed"};
  const auto shown = [](const CostValue& value) {
    return fmt::format("{} | {}: {}", value.value, kBases[static_cast<std::size_t>(value.basis)], value.source);
  };
  for (const CostRow& row : kCostTable)
    EXPECT_THAT(page, testing::HasSubstr(fmt::format("| `{}.{}` | {} | {} | {} |\n", row.section, row.key, row.unit,
                                                     shown(row.n45), shown(row.n7))));
}

TEST_F(EnergyRun, ABudgetGivesTheLargestMachineWithinIt) {
  const double budget = 30;
  const Json r = run("ring", {"area.budget_mm2=30"});
  const auto resources = r["config"]["topology"]["resources"].get<int>();
  EXPECT_LE(r["area"]["mm2"].get<double>(), budget);
  const Json larger = run("ring", {fmt::format("topology.resources={}", resources + 1)});
  EXPECT_GT(larger["area"]["mm2"].get<double>(), budget);
  EXPECT_GT(resources, 8);

  const auto refused = [&](const std::vector<std::string>& sets) {
    std::vector<std::string> arguments{"run", "machine.yaml", "--out", "refused"};
    add_sets(arguments, sets);
    const Outcome outcome = program_.run(arguments);
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused({"area.budget_mm2=3"}), HasSubstr("no number of resources makes a machine of at most 3 mm2"));
  EXPECT_THAT(refused({"area.budget_mm2=3", "area.fit=refuse"}), HasSubstr("expected a machine of at most 3 mm2"));
  EXPECT_THAT(refused({"area.budget_mm2=3", "energy.profile=none"}), HasSubstr("expected energy.profile: n45 or n7"));
  EXPECT_THAT(refused({"engine.kind=native"}), HasSubstr("the native engine has no count of joules"));
}

TEST_F(EnergyRun, IsAbsentWithoutAProfile) {
  const Json r = run("ring", {}, "none");
  for (const char* section : {"energy", "area", "costs"}) EXPECT_FALSE(r.contains(section)) << section;
}

}  // namespace
}  // namespace carousel::energy_test

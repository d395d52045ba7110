// Where the parts of a machine stand in its drawing.
#include "report/html/machine_places.h"

#include <cmath>

#include <gtest/gtest.h>

#include "report/html/still.h"

namespace carousel::report::html {
namespace {

using Json = nlohmann::ordered_json;

Json report_of(const std::string& shape, std::size_t resources, const std::vector<std::pair<int, int>>& links) {
  Json report{{"config", {{"topology", {{"shape", shape}, {"resources", resources}}}}},
              {"engine", {{"cycles", 100}}},
              {"resources", Json::array()},
              {"links", Json::array()}};
  for (std::size_t i = 0; i < resources; ++i)
    report["resources"].push_back({{"resource", i}, {"units", {{"box", {{"busy", 10}}}}}});
  for (const auto& [from, to] : links)
    report["links"].push_back({{"from", from}, {"to", to}, {"utilisation", 0.5}, {"packets", 1}});
  return report;
}

double apart(const Place& a, const Place& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

TEST(MachinePlaces, NeighboursOfALongRingStandBesideEachOther) {
  for (const std::size_t n : {25u, 31u, 64u, 65u, 96u, 100u, 127u}) {
    const MachinePlaces places = machine_places(report_of("ring", n, {}));
    ASSERT_EQ(places.at.size(), n);
    EXPECT_GE(places.least_gap(), 1) << n;
    for (std::size_t i = 0; i < n; ++i) EXPECT_LE(apart(places.at[i], places.at[(i + 1) % n]), 1.5) << n << " " << i;
  }
}

TEST(MachinePlaces, RingsOfRingsDoNotLieOverOneAnother) {
  for (const std::size_t groups : {2u, 3u, 4u, 8u}) {
    const std::size_t n = 4 * groups;
    std::vector<std::pair<int, int>> links;
    for (std::size_t g = 0; g < groups; ++g) links.emplace_back(n + g, n + (g + 1) % groups);
    const MachinePlaces places = machine_places(report_of("hierarchical", n, links));
    ASSERT_EQ(places.at.size(), n + groups);
    double within = 1e9;  // neighbours of one ring
    for (std::size_t k = 0; k + 1 < 4; ++k) within = std::min(within, apart(places.at[k], places.at[k + 1]));
    EXPECT_GE(places.least_gap(), 0.7 * within) << groups;
  }
}

TEST(MachinePlaces, ADrawnNetworkStandsWhereItsNodesAre) {
  Json report = report_of("graph", 2, {{0, 2}, {2, 1}});
  report["drawing"] = {{{"x_mm", 0}, {"y_mm", 0}}, {{"x_mm", 4}, {"y_mm", 0}}, {{"x_mm", 2}, {"y_mm", 3}}};
  const MachinePlaces places = machine_places(report);
  ASSERT_EQ(places.at.size(), 3);
  EXPECT_EQ(places.at[2].y, -3);  // upwards
}

TEST(StillMachine, HasANumberForEachOf64Resources) {
  const std::string svg = still_machine(report_of("ring", 64, {{0, 1}, {1, 0}})).str();
  for (int i = 0; i < 64; ++i) EXPECT_NE(svg.find(">" + std::to_string(i) + "</text>"), svg.npos) << i;
}

// A packet process that serves resources has no units, and so no colour of one that does nothing.
TEST(StillMachine, PacketProcessesAreNotIdleResources) {
  Json report = report_of("graph", 3, {{0, 2}, {2, 1}});
  report["config"]["topology"]["nodes"] = {{{"kind", "resource"}, {"count", 2}},
                                           {{"kind", "packet_process"}, {"serves", "r[*]"}}};
  report["drawing"] = {{{"name", "r[0]"}, {"x_mm", 0}, {"y_mm", 0}},
                       {{"name", "r[1]"}, {"x_mm", 4}, {"y_mm", 0}},
                       {{"name", "p"}, {"x_mm", 2}, {"y_mm", 3}}};
  report["resources"][2] = {{"resource", 2}, {"units", {{"box", {{"busy", 0}}}}}};
  EXPECT_EQ(uses_of_resources(report), (std::vector<double>{0.1, 0.1}));
  const std::string svg = still_machine(report).str();
  EXPECT_NE(svg.find(">10 %</text>"), svg.npos);
  EXPECT_EQ(svg.find(">0 %</text>"), svg.npos);
  EXPECT_NE(svg.find(">p</text>"), svg.npos);
}

TEST(StillGains, CutALargeLossAndSaySo) {
  const std::string bars = still_gains({{"a", "+10 %", 0.1, 0.05, 0.15}, {"b", "-75 %", -0.75, -0.8, -0.7}}).str();
  EXPECT_NE(bars.find("(cut)"), bars.npos);
  EXPECT_NE(bars.find("class=\"worse\""), bars.npos);
  EXPECT_NE(bars.find("class=\"better\""), bars.npos);
  EXPECT_EQ(still_gains({{"a", "+10 %", 0.1, 0.05, 0.15}}).str().find("(cut)"), std::string::npos);
}

}  // namespace
}  // namespace carousel::report::html

// What the page of a run says of series, own shapes, power and the conventional twin.
#include "report/html/run_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace carousel::report::html {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::Not;

Json small_run() {
  return {{"scene", {{"name", "balls"}}},
          {"config", {{"engine", {{"clock_mhz", 1000}}}, {"topology", {{"resources", 2}, {"shape", "ring"}}}}},
          {"engine", {{"kind", "cycle"}, {"cycles", 1000}, {"deterministic", true}}},
          {"rays", {{"emitted", 100}, {"completed", 100}, {"lost", 0}}},
          {"tests", {{"box", {{"count", 500}, {"per_ray", 5.0}}}, {"triangle", {{"count", 100}, {"per_ray", 1.0}}}}},
          {"digest", {{"hits", "abcd"}}}};
}

/// The page without its scripts, which are long.
std::string page(const Json& report, const Json* versus = nullptr, const HeatMap& heat = {}) {
  const std::string all = run_page(report, {}, heat, versus);
  return all.substr(0, all.find("<script"));
}

Json link_of(int from, int to, double use) {
  return {{"from", from}, {"to", to}, {"packets", 10}, {"utilisation", use}};
}

TEST(RunPageText, ShowsTheFramesOfASeries) {
  Json report = small_run();
  EXPECT_THAT(page(report), Not(HasSubstr("table-frames")));
  report["frames"] = {{"count", 2},  {"cycles", 2500},          {"builder_cycles", 500},
                      {"rays", 200}, {"limited_by_builder", 1}, {"worn", 0}};
  report["frames"]["rows"] = {
      {{"frame", 4}, {"update", "built"}, {"cycles", 1200}, {"box_tests", 500}, {"primitive_tests", 70}},
      {{"frame", 5},
       {"update", "refit"},
       {"cycles", 800},
       {"box_tests", 600},
       {"primitive_tests", 30},
       {"builder", {{"cycles", 500}}}}};
  const std::string text = page(report);
  EXPECT_THAT(text, HasSubstr("2 frames, 200 rays, 2,500 cycles, 20.0 % of them the builder"));
  EXPECT_THAT(text, HasSubstr("In 1 frame the update takes longer than the rays."));
  EXPECT_THAT(text, Not(HasSubstr("so worn")));
  for (const char* id : {"table-frames", "table-frame-cycles", "table-frame-tests", "fig-frame-cycles"})
    EXPECT_THAT(text, HasSubstr(id));
  EXPECT_THAT(text, HasSubstr("data-v=\"630\"")) << "both tests of a frame";
  report["frames"]["rows"][0].erase("cycles");
  report["frames"]["rows"][1].erase("cycles");
  EXPECT_THAT(page(report), Not(HasSubstr("fig-frame-cycles"))) << "the native engine has no cycles";
}

TEST(RunPageText, TellsTestsOfOwnShapesAndTheirPrograms) {
  Json report = small_run();
  EXPECT_THAT(page(report), Not(HasSubstr("procedural primitives")));
  report["tests"]["procedural"] = {{"count", 200}, {"per_ray", 2.0}};
  EXPECT_THAT(page(report), HasSubstr("2 tests of procedural primitives"));
  EXPECT_THAT(page(report), Not(HasSubstr("by programs of")));
  report["tests"]["programs"] = {{"count", 100}, {"per_ray", 1.0}};
  report["tests"]["program_cycles"] = {{"count", 4150}, {"per_ray", 41.5}};
  EXPECT_THAT(page(report), HasSubstr("2 tests of procedural primitives, 1 of them by programs of 41.5 cycles each"));
}

TEST(RunPageText, TellsWhenPowerIsHighest) {
  Json report = small_run();
  report["energy"] = {{"watts", 2.0}, {"nj_per_ray", 1.0}, {"joules", 1e-3}, {"rays_per_joule", 1e6}};
  report["energy"]["peak"] = {{"first_cycle", 3072},   {"cycles", 1024}, {"resolution", 64}, {"watts", 3.0},
                              {"watts_at_most", 3.25}, {"part", "dram"}, {"part_share", 0.5}};
  EXPECT_THAT(page(report), HasSubstr("Power is highest in the 1,024 cycles from cycle 3,072 on: 3 W, 1.50 times the "
                                      "mean of the run. There DRAM takes 50.0 % of it."));
}

TEST(RunPageText, LeavesKeysOfAVerdictAsTheyAre) {
  Json report = small_run();
  report["bottleneck"] = {{"limits", ""},
                          {"verdict", "no class: half memory.l2_latency_cycles gains, and l2_port does not"},
                          {"gains", Json::array()}};
  EXPECT_THAT(page(report), HasSubstr("No class: half memory.l2_latency_cycles gains, and L2 port does not."));
}

TEST(RunPageText, DrawsWhereTheCyclesOfRaysGo) {
  Json report = small_run();
  report["ray_time"] = {{"rays", 100}, {"latency", 40.0}, {"cycles", 4000}, {"collection", 3000}, {"test", 1000}};
  report["ray_time"]["by_kind"] = Json::array();
  const std::string text = page(report);
  EXPECT_THAT(text, HasSubstr("fig-ray-time"));
  EXPECT_LT(text.find("<span>waiting in collections</span>"), text.find("<span>in test</span>")) << "without scripts";
  EXPECT_NE(text.find("<span>waiting in collections</span>"), text.npos);
  EXPECT_THAT(text, HasSubstr("A ray spends 75.0 % of its 40.00 cycles waiting in collections, and 25.0 % in test."));
  EXPECT_THAT(text, HasSubstr("<dt>Latency</dt><dd>40.00 cycles until it is shaded</dd>"));
}

TEST(RunPageText, DrawsTheCyclesOfEachKindOfRayAlsoWithoutScripts) {
  Json report = small_run();
  report["ray_time"] = {{"rays", 100}, {"latency", 40.0}, {"cycles", 4000}, {"collection", 3000}, {"test", 1000}};
  report["ray_time"]["by_kind"] = {
      {{"kind", "camera"}, {"bounce", 0}, {"rays", 60}, {"cycles", 3000}, {"collection", 2400}, {"test", 600}},
      {{"kind", "shadow"}, {"bounce", 0}, {"rays", 40}, {"cycles", 1000}, {"collection", 600}, {"test", 400}}};
  const std::string text = page(report);
  const std::size_t figure = text.find("id=\"fig-ray-time-kinds\" data-chart=\"amounts\"");
  ASSERT_NE(figure, text.npos);
  const std::string still = text.substr(figure, text.find("</figure>", figure) - figure);
  // A camera ray takes 50 cycles, 40 of them in collections, and a shadow ray 25, 15 of them there: of the longest bar
  // these are 800, 200, 300 and 200 thousandths.
  for (const char* piece :
       {"x=\"0\" width=\"800\"", "x=\"800\" width=\"200\"", "x=\"0\" width=\"300\"", "x=\"300\" width=\"200\""})
    EXPECT_THAT(still, HasSubstr(piece));
}

TEST(RunPageText, NamesTheLinkThatIsBusiest) {
  Json report = small_run();
  report["resources"] = {{{"resource", 0}}, {{"resource", 1}}};
  report["links"] = {link_of(0, 1, 0.05), link_of(1, 2, 0.997), link_of(2, 0, 0.05)};
  report["bound"] = {{"reached", 0.168}, {"classes", {{{"name", "link_bandwidth"}, {"rays_per_kilocycle", 534.02}}}}};
  const std::string text = page(report);
  EXPECT_THAT(text,
              HasSubstr("Of the links, that from resource 1 to bridge 0 is busiest: it moves packets in 99.7 % of "
                        "the cycles, where a link does in 36.6 % in the mean."));
  EXPECT_THAT(text,
              HasSubstr("link bandwidth would allow 534.0 rays in 1,000 cycles, if all links carried as much; the "
                        "run reached 16.8 % of that."));
  report["drawing"] = {{{"name", "left"}}, {{"name", "right"}}, {{"name", "door"}}};
  EXPECT_THAT(page(report), HasSubstr("that from right to door is busiest"));
  report["links"][1]["utilisation"] = 0.05;
  EXPECT_THAT(page(report), Not(HasSubstr("is busiest"))) << "of alike ones none is";
  EXPECT_THAT(page(report), HasSubstr("Each link moves packets in 5.0 % of the cycles."));
}

TEST(RunPageText, TellsFirstWhatStandsBehindThePartThatLimits) {
  Json report = small_run();
  report["shading"] = {{"utilisation", 0.991}};
  report["packets"] = {{"issued", 0}, {"rays_mean", 0.0}, {"bubble_fraction", 0.0}};
  report["memory"] = {{"dram_utilisation", 0.256},
                      {"caches", {{{"lines", 100}, {"hits", 80}}, {{"lines", 300}, {"hits", 150}}}},
                      {"dram", {{"row_hit_fraction", 0.25}}}};
  report["memory"]["dram"]["channels"] = {{{"reads", 30}, {"writes", 10}, {"row_conflicts", 24}}};
  report["bottleneck"] = {{"limits", ""}, {"verdict", "not found out"}, {"gains", Json::array()}};
  report["bound"] = {{"reached", 0.5}, {"classes", {{{"name", "shading"}, {"rays_per_kilocycle", 100.0}}}}};
  std::string text = page(report);
  EXPECT_THAT(text, Not(HasSubstr("A packet holds"))) << "there are none";
  EXPECT_THAT(text, HasSubstr("DRAM moves data in 25.6 % of the cycles, 25.0 % of its accesses find their row open and "
                              "60.0 % another one; 57.5 % of the lines asked for are in the L2."));
  EXPECT_LT(text.find("Shader workers are busy"), text.find("DRAM moves data")) << "the tightest part's";
  EXPECT_THAT(text, HasSubstr("The gain of a change was not measured."));
  report["bottleneck"]["limits"] = "memory_bandwidth";
  text = page(report);
  EXPECT_LT(text.find("DRAM moves data"), text.find("Shader workers are busy"));
}

TEST(RunPageText, SaysWhyNoLimitWasSearchedFor) {
  Json report = small_run();
  EXPECT_THAT(page(report), HasSubstr("The search for the limiting part was switched off"));
  report["config"]["engine"]["what_if"] = true;
  EXPECT_THAT(page(report), Not(HasSubstr("switched off")));
  report["sampled"] = {{"paths", 10},
                       {"frame_paths", 100},
                       {"strata", 2},
                       {"uses", Json::array()},
                       {"cycles_per_ray", {{"estimate", 2.0}, {"low", 1.0}, {"high", 3.0}}}};
  EXPECT_THAT(page(report), HasSubstr("without sampling.fraction it is"));
}

TEST(RunPageText, LeavesKeysAtTheStartOfAChangeAsTheyAre) {
  Json report = small_run();
  report["bottleneck"] = {{"limits", "shading_order"}, {"verdict", "shading_order"}, {"rivals", Json::array()}};
  report["bottleneck"]["gains"] = {{{"name", "shading_order"},
                                    {"action", "shading.sort: shader"},
                                    {"gain", 0.5},
                                    {"low", 0.4},
                                    {"high", 0.6},
                                    {"together", 1},
                                    {"sets", {"shading.sort=shader"}}}};
  EXPECT_THAT(page(report), HasSubstr("<strong>shading.sort: shader</strong>"));
  report["bottleneck"]["gains"][0]["action"] = "twice shading.workers";
  EXPECT_THAT(page(report), HasSubstr("<strong>Twice shading.workers</strong>"));
}

TEST(RunPageText, IsOfTrafficWhereThereIsNoScene) {
  Json report = small_run();
  report["scene"]["name"] = "none";
  report["traffic"] = {{"packets", 7},
                       {"delivered", 7},
                       {"accepted", 0.1},
                       {"offered", 0.1},
                       {"latency", {{"mean", 20.0}, {"p50", 18}, {"p99", 40}, {"quantiles", Json::array()}}}};
  EXPECT_THAT(page(report), HasSubstr("<h1>Carousel: synthetic traffic</h1>"));
}

TEST(RunPageText, SaysWithHowManySamplesAFrameIsLargeEnough) {
  Json report = small_run();
  report["config"]["image"] = {{"width", 160}, {"height", 100}, {"samples", 2}};
  report["bottleneck"] = {{"limits", ""},
                          {"verdict", "not found out"},
                          {"gains", Json::array()},
                          {"frame_too_small", {{"paths", 32000}, {"least_paths", 67000}}}};
  const std::string text = page(report);
  EXPECT_THAT(text, HasSubstr("at least 67,000 paths"));
  EXPECT_THAT(text, HasSubstr("<code>--set image.samples=5</code>")) << "2 * 67,000 / 32,000, rounded up";
  report["config"].erase("image");
  EXPECT_THAT(page(report), Not(HasSubstr("image.samples"))) << "of a list of rays";
}

TEST(RunPageText, HasNoSectionOfCollectionsWhereNoneWereMade) {
  Json report = small_run();
  report["collections"] = {{"created", 0}, {"fullness_mean", 0.0}};
  EXPECT_THAT(page(report), Not(HasSubstr("full when it was issued")));
  report["collections"]["created"] = 3;
  EXPECT_THAT(page(report), HasSubstr("full when it was issued"));
}

TEST(RunPageText, ListsWhatCostsNothingAndKeysWithoutEffect) {
  Json report = small_run();
  EXPECT_THAT(page(report), Not(HasSubstr("Not charged")));
  report["charges"] = {{{"name", "path_state"},
                        {"meaning", "states are there"},
                        {"key", "memory.path_state"},
                        {"set", "memory.path_state=memory"}},
                       {{"name", "crossbars"}, {"meaning", "routers switch"}, {"key", ""}, {"set", ""}}};
  report["ignored_keys"] = {"packets.rays"};
  const std::string text = page(report);
  EXPECT_THAT(text,
              HasSubstr("<td>states are there</td><td>memory.path_state</td><td>--set memory.path_state=memory</td>"));
  EXPECT_THAT(text, HasSubstr("<td>routers switch</td><td>none</td>"));
  EXPECT_THAT(text, HasSubstr("<th scope=\"row\">packets.rays</th>"));
}

TEST(RunPageText, PacksTheNumbersOfAllPixels) {
  Json report = small_run();
  report["config"]["image"] = {{"width", 2}, {"height", 1}, {"samples", 1}};
  report["heat"] = {{"cycles_mean", 20.0}, {"slowest", {{{"x", 1}, {"y", 0}, {"rays", 1}, {"cycles", 30}}}}};
  const char* const rows = "x,y,rays,cycles,tests,hops,waiting\n0,0,1,10,2,3,4\n1,0,1,30,5,6,7\n";
  const HeatMap map{{"image/png", "P"}, rows};
  EXPECT_THAT(run_page(report, {}, map), HasSubstr("id=\"heat-head\">{\"width\":2,\"samples\":2,\"rows\":[{"));
  EXPECT_THAT(page(report, nullptr, map), HasSubstr("id=\"heat-map\""));
  EXPECT_THAT(page(report, nullptr, map), HasSubstr("class=\"map still\""))
      << "the picture is for pages without scripts";
  for (const char* wrong : {"", "x\n", "x,y\n0,0,1,10,2,3,4\n", "x,y\n0,0,1,10,2,3,4\n1,0,1,30,5,6\n",
                            "x,y\n0,0,1,10,2,3,4\n1,0,1,30,5,6,7"}) {
    const std::string text = run_page(report, {}, {map.picture, wrong});
    EXPECT_THAT(text, Not(HasSubstr("id=\"heat-head\""))) << wrong;
    EXPECT_THAT(text.substr(0, text.find("<script")), HasSubstr("class=\"map\""));
  }
}

TEST(RunPageText, HasTheTwinBesideTheAnswersOfTheSameMachineOnly) {
  Json versus = {{"against",
                  {{{"than", "twin"},
                    {"verdict", "slower"},
                    {"speed", {{"ratio", 0.8}, {"low", 0.75}, {"high", 0.85}}},
                    {"bytes", {{"ratio", 0.5}}},
                    {"joules", {{"ratio", 0.9}}}}}},
                 {"machines", {{{"name", "twin"}, {"limits", "memory_bandwidth"}}}},
                 {"runs",
                  {{{"machine", "twin"}, {"hits", "abcd"}, {"cycles", 1000}},
                   {{"machine", "machine"}, {"hits", "abcd"}, {"cycles", 1000}}}}};
  const Json report = small_run();
  EXPECT_TRUE(is_of_run(versus, report));
  const std::string text = page(report, &versus);
  EXPECT_THAT(text, HasSubstr("this machine is slower: 0.80 times the rays a cycle (0.75 to 0.85)"));
  EXPECT_THAT(text, HasSubstr("memory bandwidth"));
  Json close = versus;
  close["against"][0]["speed"] = {{"ratio", 1.0114}, {"low", 1.0101}, {"high", 1.0123}};
  EXPECT_THAT(page(report, &close), HasSubstr("1.011 times the rays a cycle (1.010 to 1.012)"));
  EXPECT_THAT(page(report), Not(HasSubstr("conventional machine does")));
  versus["runs"][1]["cycles"] = 999;
  EXPECT_FALSE(is_of_run(versus, report)) << "the twin alone has so many cycles";
  versus["runs"][1]["cycles"] = 1000;
  versus["runs"][1]["hits"] = "other";
  EXPECT_FALSE(is_of_run(versus, report));
}

}  // namespace
}  // namespace carousel::report::html

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
std::string page(const Json& report, const Json* versus = nullptr) {
  const std::string all = run_page(report, {}, {}, versus);
  return all.substr(0, all.find("<script"));
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
  EXPECT_LT(text.find("<span>collection</span>"), text.find("<span>test</span>")) << "also without scripts";
  EXPECT_NE(text.find("<span>collection</span>"), text.npos);
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
  EXPECT_THAT(page(report), Not(HasSubstr("conventional machine does")));
  versus["runs"][1]["cycles"] = 999;
  EXPECT_FALSE(is_of_run(versus, report)) << "the twin alone has so many cycles";
  versus["runs"][1]["cycles"] = 1000;
  versus["runs"][1]["hits"] = "other";
  EXPECT_FALSE(is_of_run(versus, report));
}

}  // namespace
}  // namespace carousel::report::html

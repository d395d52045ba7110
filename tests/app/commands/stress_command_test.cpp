#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/stress/ring_queues.h"
#include "report/run/report_json.h"
#include "tests/app/support/program.h"
#include "tests/support/json_schema_check.h"

namespace carousel::stress_command_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

TEST(StressCommand, TriesQueuesAndLeavesResults) {
  const Program program;
  const Outcome outcome =
      program.run({"stress", "--seconds", "0.5", "--messages", "2000", "--repetitions", "2", "--queue",
                   "spsc_ring,mpmc_ring,mutex", "--pattern", "stream,ping_pong,many_to_many"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("nothing lost, doubled, reordered or torn; nothing stuck"));
  EXPECT_THAT(outcome.out, HasSubstr("ping_pong, 64 bytes, 2 threads, capacity 64"));
  EXPECT_THAT(outcome.out, HasSubstr("files: out/stress/stress.json"));
  const Json json = Json::parse(program.read("out/stress/stress.json"));
  EXPECT_EQ(schema_problems(report::report_schema()["$defs"]["stress"], json), std::vector<std::string>{});
  ASSERT_EQ(json["rows"].size(), 3u * 3 + 3 + 2);  // spsc_ring does not fit many_to_many; stream has three sizes
  for (const Json& row : json["rows"]) {
    EXPECT_GT(row["messages"].get<int>(), 0);
    EXPECT_GT(row["rate_median"].get<double>(), 0);
    EXPECT_EQ(row["found"], "");
    EXPECT_EQ(row.contains("round_trip"), row["pattern"] == "ping_pong");
    EXPECT_EQ(row.contains("transit"), row["pattern"] != "ping_pong");
  }
}

TEST(StressCommand, TriesQueuesInsideTheRing) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: cornell}\nimage: {width: 16, height: 16, samples: 1}\ntopology: {resources: 3, link: "
                "{depth: 4}}\n");
  const Outcome outcome =
      program.run({"stress", "a.yaml", "--seconds", "0.1", "--messages", "500", "--repetitions", "2", "--queue",
                   "spsc_ring,mutex", "--pattern", "stream", "--depths", "1,4", "--pairs", "3", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(schema_problems(report::report_schema()["$defs"]["stress"], json), std::vector<std::string>{});
  ASSERT_EQ(json["ring"].size(), 4u);
  for (const Json& row : json["ring"]) {
    EXPECT_GT(row["rate_median"].get<double>(), 0);
    EXPECT_EQ(row["same_digest"], true);
    EXPECT_LE(row["occupancy_mean"].get<double>(), row["depth"].get<double>());
  }
  const Json& pairs = json["ring_pairs"];
  EXPECT_EQ(pairs["pairs"], 3);
  EXPECT_EQ(pairs["difference"], false);  // whatever the rates
  EXPECT_FALSE(pairs.contains("ratio_least"));
  EXPECT_EQ(pairs["first"]["depth"], pairs["second"]["depth"]);  // designs are compared, not depths
  EXPECT_NE(pairs["first"]["queue"], pairs["second"]["queue"]);
  const std::string verdict = json["ring_verdict"];
  EXPECT_THAT(verdict, HasSubstr("no difference shown between "));
  EXPECT_THAT(verdict, HasSubstr(" of 3 pairs of runs, median "));
  EXPECT_THAT(verdict, HasSubstr("; fewer than 8 pairs show nothing"));
}

TEST(StressCommand, TriesTheQueuesThatHandRaysOver) {
  const Program program;
  program.write("a.yaml",
                "scene: {builtin: cornell}\nimage: {width: 32, height: 32, samples: 1}\ntopology: {resources: 3}\n"
                "engine: {threads: 2}\nrays: {slots_per_resource: 64}\npackets: {rays: 4}\n");
  for (const std::string key : {"shading.queue", "rays.queue"}) {
    SCOPED_TRACE(key);
    const Outcome outcome =
        program.run({"stress", "a.yaml", "--in", key, "--seconds", "0.05", "--messages", "100", "--repetitions", "1",
                     "--pattern", "stream", "--depths", "1,64", "--pairs", "0", "--json", "--force"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Json json = Json::parse(outcome.out);
    EXPECT_EQ(json["ring_key"], key);
    ASSERT_EQ(json["ring"].size(), 5u * 2);  // the kinds that serve several threads
    for (const Json& row : json["ring"]) {
      EXPECT_EQ(row["same_digest"], true);
      EXPECT_GE(row["occupancy_mean"].get<double>(), 1.0);
      EXPECT_LE(row["occupancy_mean"].get<double>(), row["depth"].get<double>());
    }
    EXPECT_GT(json["ring"][0]["refused"].get<double>(), 0);  // this row has depth 1
    // A design for one thread on each side is refused by name.
    const Outcome refused = program.run({"stress", "a.yaml", "--in", key, "--queue", "spsc_ring", "--seconds", "0.05",
                                         "--messages", "100", "--pattern", "stream", "--force"});
    EXPECT_EQ(refused.status, key == "shading.queue" ? 2 : 0) << refused.err;
    if (key == "shading.queue") {
      EXPECT_THAT(refused.err, HasSubstr("shading.queue: spsc_ring is made for one"));
    }
  }
}

TEST(StressCommand, ClaimsADifferenceInsideTheRingOnlyWithAnInterval) {
  report::StressPairs pairs;
  pairs.first = {"spsc_ring", 16};
  pairs.second = {"mutex", 1};
  pairs.pairs = 12;
  pairs.wins = 12;
  pairs.ratio = 1.3;
  pairs.ratio_least = 1.2;
  pairs.ratio_most = 1.4;
  pairs.difference = true;
  EXPECT_EQ(app::ring_verdict(pairs),
            "spsc_ring of depth 16 is faster than mutex of depth 1: it traced more rays a second in 12 of 12 pairs of "
            "runs, median +30.0 %, 99 % interval +20.0 % to +40.0 %");
  pairs.wins = 7;
  pairs.ratio = 1.02;
  pairs.ratio_least = 0.97;
  pairs.ratio_most = 1.06;
  pairs.difference = false;
  EXPECT_EQ(app::ring_verdict(pairs),
            "no difference shown between spsc_ring of depth 16 and mutex of depth 1: the first traced more rays a "
            "second in 7 of 12 pairs of runs, median +2.0 %, 99 % interval -3.0 % to +6.0 %");
}

TEST(StressCommand, RefusesWhatThereIsNot) {
  const Program program;
  const auto error_of = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(error_of({"stress", "--queue", "spsc"}), HasSubstr("found spsc"));
  EXPECT_THAT(error_of({"stress", "--pattern", "streem"}), HasSubstr("did you mean stream?"));
  EXPECT_THAT(error_of({"stress", "--in", "shading.quue"}), HasSubstr("did you mean shading.queue?"));
  EXPECT_THAT(error_of({"stress", "--bytes", "9"}), HasSubstr("expected 8, 64 or 256, found 9"));
  EXPECT_THAT(error_of({"stress", "--queue", "boost_spsc", "--pattern", "many_to_many"}),
              HasSubstr("boost_spsc is made for one producer at a time"));
}

}  // namespace
}  // namespace carousel::stress_command_test

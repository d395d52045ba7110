// `carousel run --trace`: a file of Chrome's trace events that holds to its format.
#include <algorithm>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::trace_run_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 12, height: 8, samples: 1}\n"
    "engine: {kind: cycle, threads: 2, what_if: false}\ntopology: {resources: 3}\nrays: {slots_per_resource: 32}\n";

/// Checks each event by the fields that its phase needs, and the nesting of slices and ends of flows. Returns how many
/// there are of each phase.
std::map<std::string, std::size_t> check_events(const Json& trace, double end) {
  std::map<std::string, std::size_t> phases;
  std::map<std::pair<int, int>, std::vector<std::pair<double, double>>> tracks;
  std::map<std::pair<int, int>, std::string> names;
  std::map<std::uint64_t, std::string> flows;
  for (const Json& event : trace.at("traceEvents")) {
    const std::string phase = event.at("ph");
    ++phases[phase];
    const std::pair track{event.at("pid").get<int>(), event.at("tid").get<int>()};
    const double at = event.at("ts");
    EXPECT_FALSE(event.at("name").get<std::string>().empty());
    EXPECT_GE(at, 0);
    EXPECT_LE(at, end);
    if (phase == "M") {
      const bool sort = event["name"].get<std::string>().ends_with("sort_index");
      EXPECT_TRUE(event.at("args").contains(sort ? "sort_index" : "name"));
      if (event["name"] == "thread_name") names[track] = event["args"]["name"];
    } else if (phase == "X") {
      EXPECT_TRUE(names.contains(track));
      EXPECT_LE(at + event.at("dur").get<double>(), end * (1 + 1e-9));
      tracks[track].emplace_back(at, at + event["dur"].get<double>());
    } else if (phase == "C") {
      EXPECT_TRUE(event.at("args").at("value").is_number());
    } else {
      EXPECT_THAT(phase, testing::AnyOf("s", "t", "f"));
      EXPECT_EQ(phase == "f", event.contains("bp"));
      // It stands within a slice of its track, by which it is bound.
      EXPECT_FALSE(tracks[track].empty()) << event;
      if (!tracks[track].empty()) {
        EXPECT_EQ(tracks[track].back().first, at);
      }
      flows[event.at("id")] += phase;
    }
  }
  for (const auto& [track, slices] : tracks)
    for (std::size_t i = 1; i < slices.size(); ++i)
      EXPECT_GE(slices[i].first, slices[i - 1].second - 1e-6) << names[track];
  for (const auto& [id, way] : flows) {
    EXPECT_GE(way.size(), 2u) << id;
    EXPECT_EQ(way, "s" + std::string(way.size() - 2, 't') + "f") << id;
  }
  return phases;
}

Json trace_of(const Program& program, const std::vector<std::string>& options, const std::string& out = "out") {
  std::vector<std::string> run{"run", "small.yaml", "--quiet", "--out", out, "--trace", "trace.json"};
  run.insert(run.end(), options.begin(), options.end());
  const Outcome outcome = program.run(run);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return Json::parse(program.read("trace.json"));
}

TEST(TraceRun, IsAValidFileWhoseSlicesAddUp) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Json trace = trace_of(program, {});
  const Json report = Json::parse(program.read("out/report.json"));
  EXPECT_TRUE(trace.contains("displayTimeUnit"));
  auto phases = check_events(trace, report["engine"]["cycles"]);
  for (const char* phase : {"M", "X", "C", "s", "t", "f"}) EXPECT_GT(phases[phase], 0u) << phase;
  EXPECT_EQ(phases["s"], report["packets"]["issued"]);
  std::map<std::string, double> busy;
  std::map<int, std::string> processes;
  std::map<std::pair<int, int>, std::string> tracks;
  for (const Json& event : trace["traceEvents"]) {
    if (event["name"] == "process_name") processes[event["pid"]] = event["args"]["name"];
    if (event["name"] == "thread_name") tracks[{event["pid"], event["tid"]}] = event["args"]["name"];
    if (event["ph"] == "X")
      busy[processes[event["pid"]] + ", " + tracks[{event["pid"], event["tid"]}]] += event["dur"].get<double>();
  }
  for (std::size_t r = 0; r < 3; ++r)
    EXPECT_EQ(busy["resource " + std::to_string(r) + ", box units"],
              report["resources"][r]["units"]["box"]["busy"].get<double>());
}

TEST(TraceRun, IsTheSameOnAnyNumberOfThreads) {
  const Program program;
  program.write("small.yaml", kSmall);
  trace_of(program, {"--set", "engine.threads=1"}, "one");
  const std::string one = program.read("trace.json");
  trace_of(program, {"--set", "engine.threads=3"}, "three");
  EXPECT_TRUE(one == program.read("trace.json"));
}

TEST(TraceRun, IsSmallerForAWindowASampleAndAMost) {
  const Program program;
  program.write("small.yaml", kSmall);
  const auto slices = [](const Json& trace) {
    const auto is_slice = [](const Json& event) { return event["ph"] == "X"; };
    return std::count_if(trace["traceEvents"].begin(), trace["traceEvents"].end(), is_slice);
  };
  const auto all = slices(trace_of(program, {}));
  const Json window = trace_of(program, {"--trace-window", "2000:3000"});
  EXPECT_LT(slices(window), all / 2);
  EXPECT_GT(slices(window), 0);
  for (const Json& event : window["traceEvents"]) {
    if (event["ph"] == "M") continue;
    EXPECT_GE(event["ts"].get<double>(), 2000);
    EXPECT_LT(event["ts"].get<double>(), 3000);
  }
  check_events(window, 1e9);
  const Json sample = trace_of(program, {"--trace-sample", "10"});
  EXPECT_LT(slices(sample), all / 4);
  EXPECT_GT(slices(sample), all / 40);
  check_events(sample, 1e9);
  const Outcome cut =
      program.run({"run", "small.yaml", "--trace", "cut.json", "--trace-events", "1000", "--trace-sample", "1"});
  EXPECT_EQ(cut.status, 0);
  const auto reached = [](const std::string& warning) {
    const std::size_t at = warning.find("ends after ");
    return at == warning.npos ? 100.0 : std::stod(warning.substr(at + 11));
  };
  ASSERT_THAT(cut.err, HasSubstr(" of the time; --trace-sample "));
  // So few packets reach farther.
  const std::string every = std::to_string(std::stoi(cut.err.substr(cut.err.find("--trace-sample ") + 15)));
  EXPECT_GT(std::stoi(every), 2 * 100 / reached(cut.err) - 1);
  const Outcome sampled =
      program.run({"run", "small.yaml", "--trace", "all.json", "--trace-events", "1000", "--trace-sample", every});
  EXPECT_EQ(sampled.status, 0);
  EXPECT_GT(reached(sampled.err), 1.5 * reached(cut.err)) << cut.err << sampled.err;
  const Json few = Json::parse(program.read("cut.json"));
  EXPECT_LE(few["traceEvents"].size(), 1000u);
  EXPECT_GT(few["traceEvents"].size(), 500u);
  check_events(few, 1e9);
}

// As many packets as fit reach to the end of the run, the same ones on any number of threads.
TEST(TraceRun, HasAsManyPacketsAsFit) {
  const Program program;
  program.write("small.yaml", kSmall);
  const auto traced = [&](const char* file, std::vector<std::string> more) {
    std::vector<std::string> words{"run",  "small.yaml", "--trace", file, "--trace-events",
                                   "1000", "--force",    "--out",   "out"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome run = program.run(words);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr(std::string(file) + " has one of about ")) << run.err;
    EXPECT_THAT(run.err, Not(HasSubstr("ends after")));
    const Json trace = Json::parse(program.read(file));
    EXPECT_THAT(trace["otherData"].value("sample", ""), HasSubstr("one of about "));
    EXPECT_LE(trace["traceEvents"].size(), 1000u);
    EXPECT_GT(trace["traceEvents"].size(), 300u);
    check_events(trace, 1e9);
    return trace;
  };
  const Json trace = traced("thin.json", {"--set", "engine.threads=1"});
  double last = 0;
  for (const Json& event : trace["traceEvents"])
    if (event["ph"] == "X") last = std::max(last, event["ts"].get<double>());
  const double cycles = Json::parse(program.read("out/report.json"))["engine"]["cycles"];
  EXPECT_GT(last, 0.9 * cycles);
  EXPECT_EQ(traced("three.json", {"--set", "engine.threads=3"}), trace);
  traced("native.json", {"--set", "engine.kind=native"});
}

TEST(TraceRun, OfTheNativeEngineHasTimesOfTheHost) {
  const Program program;
  program.write("small.yaml", kSmall);
  const Json trace = trace_of(program, {"--set", "engine.kind=native"});
  const Json report = Json::parse(program.read("out/report.json"));
  auto phases = check_events(trace, report["host"]["wall_seconds"].get<double>() * 1e6 + 1e5);
  EXPECT_GT(phases["X"], 0u);
  EXPECT_EQ(phases["s"], phases["f"]);
}

TEST(TraceRun, RefusesWhatItCannotDoBeforeTheRun) {
  const Program program;
  program.write("small.yaml", kSmall);
  program.write("file", "");
  const auto refused = [&](const std::vector<std::string>& options, const std::string& message) {
    std::vector<std::string> run{"run", "small.yaml"};
    run.insert(run.end(), options.begin(), options.end());
    const Outcome outcome = program.run(run);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(program.folder() / "out"));
  };
  refused({"--trace", "file/trace.json"}, "cannot write");
  refused({"--trace", "t.json", "--trace-window", "7"}, "expected A:B");
  refused({"--trace", "t.json", "--trace-window", "9:7"}, "expected A:B");
  refused({"--trace", "t.json", "--trace-window", "1.5:7"}, "expected A:B");
  refused({"--trace", "t.json", "--trace-sample", "0"}, "--trace-sample");
  refused({"--trace-window", "1:7"}, "--trace");
  EXPECT_FALSE(std::filesystem::exists(program.folder() / "t.json"));
}

}  // namespace
}  // namespace carousel::trace_run_test

// An interrupt during any part of a run ends with the signal's status and a report that is marked incomplete, and never
// with a verdict that was not reached.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/types.h>

#include "tests/app/support/program.h"

namespace carousel::interrupted_run_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr const char* kMachine =
    "scene: {builtin: terrain, triangles: 2000}\n"
    "image: {width: 96, height: 64, samples: 2}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\n"
    "topology: {resources: 4}\nrays: {slots_per_resource: 128}\n";

/// True if the process catches the signal by now: until then it just ends it.
bool catches(pid_t pid, int number) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("SigCgt:", 0) == 0) return std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1;
  return false;
}

struct Interrupted {
  Outcome outcome;
  Json report;
};

class InterruptedRun : public testing::Test {
 protected:
  using Clock = std::chrono::steady_clock;

  InterruptedRun() { program_.write("a.yaml", kMachine); }

  /// Starts the program, and sends it a signal some time after it catches that.
  Outcome signalled(const std::vector<std::string>& words, std::chrono::duration<double> after, int number) const {
    const pid_t pid = program_.start(words);
    for (int i = 0; i < 3000 && !catches(pid, number); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    std::this_thread::sleep_for(after);
    kill(pid, number);
    return program_.wait(pid);
  }

  /// Starts a run, and interrupts it after some time.
  Interrupted interrupt(const std::vector<std::string>& sets, std::chrono::duration<double> after, int number) const {
    std::vector<std::string> run{"run", "a.yaml", "--out", "out"};
    add_sets(run, sets);
    std::filesystem::remove_all(program_.folder() / "out");
    Interrupted out{signalled(run, after, number), {}};
    const std::string text = program_.read("out/report.json");
    if (!text.empty()) out.report = Json::parse(text);
    return out;
  }

  /// Interrupts runs later and later until one has traced all its rays but not come to its end, as far as
  /// `unfinished` can tell. In any case status and report must agree.
  template <class Unfinished>
  std::optional<Interrupted> interrupt_behind_the_rays(const std::vector<std::string>& sets,
                                                       const Unfinished& unfinished) const {
    const auto start = Clock::now();
    EXPECT_EQ(program_.run({"run", "a.yaml", "--out", "timed"}).status, 0);
    std::chrono::duration<double> after = Clock::now() - start;
    for (int tries = 0; tries < 40; ++tries, after *= 1.15) {
      Interrupted now = interrupt(sets, after, SIGINT);
      if (now.report.is_null()) {
        ADD_FAILURE() << "no report: " << now.outcome.err;
        return {};
      }
      EXPECT_EQ(now.outcome.status, now.report["incomplete"] ? 130 : 0) << now.outcome.err;
      if (now.report["rays"]["lost"] == 0 && now.report["incomplete"] && unfinished(now.report)) return now;
      if (!now.report["incomplete"]) after *= 0.6;
    }
    return {};
  }

  const Program program_;
};

TEST_F(InterruptedRun, DuringTheSearchForTheBottleneckNothingIsFoundOut) {
  const auto found = interrupt_behind_the_rays({"engine.what_if=true"}, [](const Json& report) {
    return report.contains("bottleneck") && report["bottleneck"]["complete"] == false;
  });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->report["bottleneck"]["limits"], "");
  EXPECT_TRUE(found->report["bottleneck"]["gains"].empty());
  EXPECT_THAT(found->outcome.out, HasSubstr("not found out: the search was interrupted"));
  EXPECT_THAT(found->outcome.out, HasSubstr("INCOMPLETE"));
}

TEST_F(InterruptedRun, DuringTheSecondRunOfVerifyEffectsNothingIsProved) {
  const auto found = interrupt_behind_the_rays({"verify=effects"},
                                               [](const Json& report) { return !report["shading"].contains("proof"); });
  ASSERT_TRUE(found);
  EXPECT_THAT(found->outcome.out, HasSubstr("INCOMPLETE"));
}

TEST_F(InterruptedRun, DuringTheRunWithoutFaultsNothingIsCompared) {
  const auto found = interrupt_behind_the_rays(
      {"faults.compare=true", "faults.links.drop=0.001"},
      [](const Json& report) { return !report.contains("faults") || !report["faults"].contains("cycles_without"); });
  ASSERT_TRUE(found);
  EXPECT_THAT(found->outcome.out, HasSubstr("INCOMPLETE"));
}

TEST_F(InterruptedRun, TermAndHangUpEndARunAsInterruptDoes) {
  for (const auto& [number, status] : {std::pair{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}}) {
    const Interrupted run = interrupt({"image.samples=4096"}, std::chrono::milliseconds(300), number);
    EXPECT_EQ(run.outcome.status, status) << run.outcome.err;
    ASSERT_FALSE(run.report.is_null());
    EXPECT_EQ(run.report["incomplete"], true);
  }
}

// The ray of the last pixel is made at the end of a run, which here never comes.
TEST_F(InterruptedRun, FollowSaysThatItWasInterruptedAndNothingOfTheRay) {
  const std::vector<std::string> begin{"follow", "a.yaml", "--set", "image.samples=4096"};
  const std::vector<std::vector<std::string>> rays{
      {"--pixel", "95,63", "--sample", "4095"}, {"--ray", "5"}, {"--pixel", "95,63", "--bounce", "1", "--shadow"}};
  std::size_t i = 0;
  for (const auto& [number, status] : {std::pair{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}})
    for (const char* engine : {"engine.kind=cycle", "engine.kind=native"}) {
      std::vector<std::string> words = begin;
      const std::vector<std::string>& ray = rays[i++ % rays.size()];
      words.insert(words.end(), ray.begin(), ray.end());
      words.insert(words.end(), {"--set", engine});
      const Outcome outcome = signalled(words, std::chrono::milliseconds(i % 2 == 0 ? 0 : 80), number);
      EXPECT_EQ(outcome.status, status) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr("interrupted"));
      EXPECT_THAT(outcome.err, testing::Not(HasSubstr("error")));
    }
}

// The bytes to read may never come: a pipe without a writer.
TEST_F(InterruptedRun, TheFirstSignalEndsTheWaitForAPipe) {
  ASSERT_EQ(mkfifo((program_.folder() / "pipe").c_str(), 0600), 0);
  program_.write("rays.yaml", std::string(kMachine) + "workload: {rays_from: pipe}\n");
  program_.write("memory.yaml", "engine: {kind: cycle}\nworkload: {memory_trace: pipe}\n");
  const std::vector<std::vector<std::string>> commands{{"run", "rays.yaml"},
                                                       {"run", "memory.yaml"},
                                                       {"run", "pipe"},
                                                       {"sweep", "pipe", "--ask", "--tell"},
                                                       {"run", "a.yaml", "--trace", "pipe"},
                                                       {"follow", "rays.yaml", "--ray", "0"}};
  for (const std::vector<std::string>& words : commands) {
    const auto start = Clock::now();
    const Outcome outcome = signalled(words, std::chrono::milliseconds(100), SIGTERM);
    EXPECT_EQ(outcome.status, 143) << words[1] << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted: waited for "));
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(15));
  }
}

TEST_F(InterruptedRun, ItsRaysAreMarkedAndRefused) {
  const Outcome run = signalled({"run", "a.yaml", "--set", "image.samples=4096", "--dump-rays", "rays.csv"},
                                std::chrono::milliseconds(200), SIGINT);
  EXPECT_EQ(run.status, 130) << run.err;
  program_.write("rays.yaml", std::string(kMachine) + "workload: {rays_from: rays.csv}\n");
  const Outcome refused = program_.run({"run", "rays.yaml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("the run that wrote this list was interrupted"));
}

TEST_F(InterruptedRun, ASecondSignalEndsItAtOnce) {
  const pid_t pid = program_.start({"run", "a.yaml", "--set", "image.samples=65536"});
  for (int i = 0; i < 3000 && !catches(pid, SIGINT); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(pid, SIGINT);
  kill(pid, SIGTERM);
  EXPECT_THAT(program_.wait(pid).status, testing::AnyOf(128 + SIGTERM, 130));
}

}  // namespace
}  // namespace carousel::interrupted_run_test

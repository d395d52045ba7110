// A sweep that is killed, or whose disk is full, goes on where it was.
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/app/sweep/sweep_program.h"
#include "tests/support/full_disk.h"
#include "tests/support/random_runs.h"

namespace carousel::sweep_survival_test {
namespace {

using testing::HasSubstr;

class SweepSurvival : public testing::Test {
 protected:
  SweepSurvival() { program_.write("a.yaml", kTinyMachine); }
  Outcome sweep(std::vector<std::string> more) const { return program_.run(sweep_words(std::move(more))); }
  std::size_t count(const std::string& folder) const {
    std::size_t out = 0;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(program_.folder() / folder / "points", none))
      out += entry.path().extension() == ".json" && entry.path().filename().string()[0] != '.';
    return out;
  }

  Program program_;
};

/// One number of the first row that a query gives.
long long query(const std::filesystem::path& file, const char* sql) {
  sqlite3* database = nullptr;
  sqlite3_stmt* statement = nullptr;
  long long out = -1;
  if (sqlite3_open(file.c_str(), &database) == SQLITE_OK &&
      sqlite3_prepare_v2(database, sql, -1, &statement, nullptr) == SQLITE_OK && sqlite3_step(statement) == SQLITE_ROW)
    out = sqlite3_column_int64(statement, 0);
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return out;
}

const std::vector<std::string> k48Points{"--vary", "topology.resources=1..8",
                                         "--vary", "memory.l2_kib=64,512",
                                         "--vary", "packets.rays,collections.ready=(8,8),(16,16),(32,32)"};

std::vector<std::string> into(const std::string& folder, std::vector<std::string> words = k48Points) {
  words.insert(words.end(), {"--out", folder});
  return words;
}

TEST_F(SweepSurvival, KilledAgainAndAgainItEndsLikeAnUndisturbedOne) {
  ASSERT_EQ(sweep(into("calm")).status, 0);
  ASSERT_EQ(count("calm"), 48u);
  std::mt19937 random(run_seed());
  std::size_t before = 0;
  int killed = 0;
  for (int i = 0, kills = scaled(5, 2); i < kills; ++i) {
    const pid_t pid = program_.start(sweep_words(into("killed")), true);
    // Somewhere between loading the program and the eighth point after that, however busy the host is.
    const std::size_t until = before + random() % 8;
    for (int looks = 0; looks < 20'000 && count("killed") < until; ++looks)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 30));
    kill(-pid, SIGKILL);
    killed += program_.wait(pid).status == 128 + SIGKILL;
    EXPECT_GE(count("killed"), before) << "a finished point is gone";
    before = count("killed");
  }
  EXPECT_GE(killed, 1) << "the sweep was over before it was killed";
  const Outcome outcome = sweep(into("killed"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(points_of(program_.folder() / "killed"), points_of(program_.folder() / "calm"));
  for (const auto& entry : std::filesystem::directory_iterator(program_.folder() / "killed/points"))
    EXPECT_EQ(entry.path().extension(), ".json") << "a partial file stays";
  const auto ledger = program_.folder() / "killed/sweep.sqlite";
  EXPECT_EQ(query(ledger, "SELECT count(*) FROM point WHERE state = 'done'"), 48);
  EXPECT_EQ(query(ledger, "SELECT count(*) FROM point"), 48);
}

TEST_F(SweepSurvival, AnInterruptKeepsThePointsAndTellsHowToGoOn) {
  const pid_t pid = program_.start(sweep_words(into("out")));
  for (int i = 0; i < 1000 && count("out") < 3; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(pid, SIGINT);
  const Outcome outcome = program_.wait(pid);
  EXPECT_EQ(outcome.status, 130);
  EXPECT_GE(count("out"), 3u);
  EXPECT_LT(count("out"), 48u);
  EXPECT_EQ(sweep(into("out")).status, 0);
  EXPECT_EQ(count("out"), 48u);
}

TEST_F(SweepSurvival, AKilledPointFailsAloneAndCanBeRetried) {
  // The child of the child of the coordinator runs a point.
  const std::vector<std::string> words{"--vary", "topology.resources=2,4", "--jobs", "1", "--set", "image.samples=512"};
  const pid_t pid = program_.start(sweep_words(words));
  const auto child_of = [](pid_t parent) -> pid_t {
    std::ifstream in("/proc/" + std::to_string(parent) + "/task/" + std::to_string(parent) + "/children");
    pid_t child = 0;
    in >> child;
    return child;
  };
  pid_t point = 0;
  for (int i = 0; i < 2000 && point == 0; ++i) {
    if (const pid_t host = child_of(pid)) point = child_of(host);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ASSERT_NE(point, 0);
  kill(point, SIGKILL);
  const Outcome outcome = program_.wait(pid);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("failed: signal: its process was ended by signal 9"));
  EXPECT_EQ(count("out/a"), 2u);
  std::vector<std::string> again = words;
  again.push_back("--retry-failed");
  EXPECT_EQ(sweep(again).status, 0);
}

TEST_F(SweepSurvival, RefusesAFolderThatCannotBeWritten) {
  program_.write("file", "not a folder");
  const Outcome outcome = sweep(into("file"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write file: Not a directory"));
  EXPECT_EQ(program_.read("file"), "not a folder");
}

TEST_F(SweepSurvival, AFullDiskEndsItAndItGoesOnLater) {
  const std::vector<std::string> words{"--vary", "topology.resources=2,4,8", "--out", "out"};
  {
    const FullDisk full(12'000);  // less than a report
    const Outcome outcome = sweep(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("cannot write"));
  }
  EXPECT_EQ(count("out"), 0u);
  EXPECT_EQ(sweep(words).status, 0);
  EXPECT_EQ(count("out"), 3u);
}

TEST_F(SweepSurvival, OneSweepAtATimeWorksInAFolder) {
  const pid_t pid = program_.start(sweep_words({"--vary", "topology.resources=2,4", "--set", "image.samples=2048"}));
  while (!std::filesystem::exists(program_.folder() / "out/a/sweep.lock"))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  Program other;  // its output goes elsewhere
  other.write("a.yaml", kTinyMachine);
  const Outcome outcome =
      other.run(sweep_words({"--vary", "topology.resources=2", "--out", (program_.folder() / "out/a").string()}));
  kill(pid, SIGINT);
  const bool still = program_.wait(pid).status == 130;
  if (!still) GTEST_SKIP() << "the first sweep was over too soon";
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("another sweep works in"));
}

}  // namespace
}  // namespace carousel::sweep_survival_test

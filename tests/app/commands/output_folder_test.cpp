// The results of a run are there as a whole or not at all, and belong to one configuration.
#include <csignal>
#include <cstdlib>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/app/support/program.h"

namespace carousel::output_folder_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n"
    "engine: {threads: 1}\ntopology: {resources: 2}\n";

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> out;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) out.insert(entry.path().filename().string());
  return out;
}

class OutputFolder : public testing::Test {
 protected:
  OutputFolder() { program_.write("a.yaml", kSmall); }

  Outcome run(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", "a.yaml", "--out", "o"};
    words.insert(words.end(), more.begin(), more.end());
    return program_.run(words);
  }
  fs::path folder() const { return program_.folder() / "o"; }
  /// The hidden folders in the folder of the program.
  std::set<std::string> hidden() const {
    std::set<std::string> out;
    for (const std::string& name : names_in(program_.folder()))
      if (name.starts_with(".o.carousel-")) out.insert(name);
    return out;
  }

  Program program_;
};

TEST_F(OutputFolder, HoldsTheFilesOfTheLastRunOnly) {
  ASSERT_EQ(run({"--hits"}).status, 0);
  EXPECT_TRUE(fs::exists(folder() / "hits.csv"));
  ASSERT_EQ(run().status, 0);
  EXPECT_FALSE(fs::exists(folder() / "hits.csv")) << "it belonged to the run before";
  for (const char* name : {"config.resolved.yaml", "image.png", "image.exr", "report.json"})
    EXPECT_TRUE(fs::exists(folder() / name)) << name;
  EXPECT_TRUE(hidden().empty());
  struct stat status {};
  ASSERT_EQ(stat(folder().c_str(), &status), 0);
  const mode_t mask = umask(0);
  umask(mask);
  EXPECT_EQ(status.st_mode & 0777, 0777 & ~mask) << "others may read it as they may other folders";
}

TEST_F(OutputFolder, KeepsWhatOtherProgramsPutThere) {
  ASSERT_EQ(run({"--hits"}).status, 0);
  program_.write("o/notes.txt", "mine");
  fs::create_directory(folder() / "more");
  ASSERT_EQ(run().status, 0);
  EXPECT_EQ(program_.read("o/notes.txt"), "mine");
  EXPECT_TRUE(fs::exists(folder() / "more"));
  EXPECT_FALSE(fs::exists(folder() / "hits.csv"));
  EXPECT_TRUE(fs::exists(folder() / "report.json"));
  EXPECT_TRUE(hidden().empty());
}

TEST_F(OutputFolder, OfAnotherConfigurationIsRefused) {
  ASSERT_EQ(run().status, 0);
  const std::string before = program_.read("o/report.json");
  const Outcome refused = run({"--set", "image.samples=2"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err,
              HasSubstr("error: --out: o holds the results of another configuration, with image.samples=1, "
                        "not image.samples=2; expected a folder of its own (--out DIR), or --force"));
  EXPECT_EQ(program_.read("o/report.json"), before);
  EXPECT_EQ(run({"--set", "engine.threads=2"}).status, 0) << "threads of the host are no other configuration";
  EXPECT_EQ(run({"--set", "image.samples=2", "--force"}).status, 0);
  EXPECT_EQ(nlohmann::json::parse(program_.read("o/report.json"))["config"]["image"]["samples"], 2);
  EXPECT_EQ(program_.run({"run", "a.yaml", "--out", "other"}).status, 0);
}

// Results of one configuration may stand side by side; those of two never do.
TEST_F(OutputFolder, HoldsResultsOfSeveralCommandsForOneConfiguration) {
  const auto stress = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"stress",     "a.yaml", "--out",         "o",     "--seconds", "0.02",
                                   "--messages", "200",    "--repetitions", "1",     "--pairs",   "0",
                                   "--depths",   "4",      "--queue",       "mutex", "--pattern", "stream"};
    words.insert(words.end(), more.begin(), more.end());
    return program_.run(words);
  };
  const auto names = [&] { return names_in(folder()); };
  ASSERT_EQ(stress({}).status, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"config.resolved.yaml", "stress.html", "stress.json"}));
  ASSERT_EQ(run({"--hits", "--no-html"}).status, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"config.resolved.yaml", "hits.csv", "image.exr", "image.png", "report.json",
                                            "stress.html", "stress.json"}));
  ASSERT_EQ(stress({}).status, 0);
  EXPECT_TRUE(names().contains("hits.csv"));
  const Outcome refused = stress({"--set", "image.samples=2"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("error: --out: o holds the results of another configuration"));
  EXPECT_EQ(program_.run({"accuracy", "a.yaml", "--out", "o", "--set", "image.samples=2"}).status, 2);
  EXPECT_EQ(program_.run({"stress", "--out", "o"}).status, 2) << "here there is no configuration";
  ASSERT_EQ(stress({"--set", "image.samples=2", "--force"}).status, 0);
  EXPECT_EQ(names(), (std::set<std::string>{"config.resolved.yaml", "stress.html", "stress.json"}));
  EXPECT_TRUE(hidden().empty());
}

TEST_F(OutputFolder, IsTriedBeforeTheRun) {
  program_.write("o", "a file");
  const Outcome outcome = run({"--set", "scene={file: missing.glb}"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("cannot write o/: it is not a folder")) << "the scene is not even looked for";
  if (geteuid() != 0) {
    fs::create_directory(program_.folder() / "closed");
    fs::permissions(program_.folder() / "closed", fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(program_.run({"run", "a.yaml", "--out", "closed/o"}).status, 2);
  }
}

TEST_F(OutputFolder, NothingIsLeftOfARunThatFails) {
  EXPECT_EQ(program_.run({"run", "a.yaml", "--set", "scene={file: missing.glb}", "--out", "x/y/o"}).status, 2);
  EXPECT_FALSE(fs::exists(program_.folder() / "x"));
}

TEST_F(OutputFolder, LeftOversOfAKilledRunDisappearWithTheNext) {
  const pid_t pid = program_.start({"run", "a.yaml", "--out", "o", "--set", "image.samples=4000"});
  for (int i = 0; i < 2000 && hidden().empty(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::set<std::string> during = hidden();
  EXPECT_EQ(during.size(), 1u);
  EXPECT_EQ(run().status, 0);
  EXPECT_EQ(hidden(), during) << "a run that goes on is left alone";
  kill(pid, SIGKILL);
  program_.wait(pid);
  EXPECT_EQ(hidden(), during);
  EXPECT_EQ(run().status, 0);
  EXPECT_TRUE(hidden().empty());
}

// A file system that takes no more bytes: the table is printed, and the old results stay. SIGXFSZ ends nothing.
TEST_F(OutputFolder, TheTableIsPrintedThoughTheDiskIsFull) {
  ASSERT_EQ(run().status, 0);
  const std::string before = program_.read("o/report.json");
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const rlimit little{16384, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &little);
  const Outcome outcome = run();
  setrlimit(RLIMIT_FSIZE, &old);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.out, HasSubstr("hits"));
  EXPECT_THAT(outcome.out, HasSubstr("files        none, they cannot be written"));
  EXPECT_THAT(outcome.err, HasSubstr("File too large"));
  EXPECT_EQ(program_.read("o/report.json"), before);
  EXPECT_TRUE(hidden().empty());
}

TEST_F(OutputFolder, TheTableFitsTheTerminal) {
  setenv("COLUMNS", "60", 1);
  const Outcome narrow = run();
  unsetenv("COLUMNS");
  const Outcome wide = run();
  ASSERT_EQ(narrow.status, 0);
  std::istringstream lines(narrow.out);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 60u) << line;
  EXPECT_NE(narrow.out, wide.out);
}

}  // namespace
}  // namespace carousel::output_folder_test

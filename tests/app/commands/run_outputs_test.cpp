// The outputs of a run are one transaction: its folder, and the files that options name. Each is there as a whole or as
// it was, whatever call of the system fails; a file of an option never costs the results.
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/host/extra_file.h"
#include "app/host/output_folder.h"
#include "core/system/error.h"
#include "core/system/file_calls.h"
#include "tests/app/support/program.h"

namespace carousel::run_outputs_test {
namespace {

namespace fs = std::filesystem;
using files::Call;
using testing::HasSubstr;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n"
    "engine: {kind: cycle, threads: 1, what_if: false}\ntopology: {resources: 2}\n";

std::set<std::string> hidden_in(const fs::path& folder) {
  std::set<std::string> out;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().filename().string().starts_with(".")) out.insert(entry.path().filename().string());
  return out;
}

class RunOutputs : public testing::Test {
 protected:
  RunOutputs() { program_.write("a.yaml", kSmall); }

  Outcome run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"run", "a.yaml", "--out", "o"};
    words.insert(words.end(), more.begin(), more.end());
    return program_.run(words);
  }
  std::string here(const std::string& name) const { return (program_.folder() / name).string(); }

  /// Writes a result and a file of an option, as a run does. Returns the errors, in words.
  std::string write(const std::string& text) const {
    std::string errors;
    try {
      app::OutputFolder folder(here("made/o"), nullptr, true, app::Results::kStress);
      app::ExtraFile extra("--trace", here("made/t/trace.json"));
      extra.write([&](AtomicFile& file) { file.write(text); });
      const std::exception_ptr failure = folder.write([&](const fs::path& staging) {
        write_file(staging / "stress.html", text);
        write_file(staging / "stress.json", text);
        extra.publish();
      });
      extra.publish();
      errors = extra.error();
      if (failure) std::rethrow_exception(failure);
    } catch (const FileError& error) {
      errors += error.what();
    }
    return errors;
  }

  const Program program_;
};

TEST_F(RunOutputs, AreWholeOrAsTheyWereWhateverCallFails) {
  const std::string old_text = "old", new_text(70'000, 'n');
  enum class Before { kNothing, kResults, kResultsAndMore };
  ASSERT_EQ(write(old_text), "");
  fs::rename(here("made"), here("before"));
  for (const Before before : {Before::kNothing, Before::kResults, Before::kResultsAndMore})
    for (int n = 0;; ++n) {
      fs::remove_all(here("made"));
      if (before != Before::kNothing) fs::copy(here("before"), here("made"), fs::copy_options::recursive);
      if (before == Before::kResultsAndMore) program_.write("made/o/notes.txt", "mine");
      int calls = 0;
      Call failed = Call::kLock;
      std::string errors;
      {
        const files::FaultScope fault([&](Call call, const fs::path&) {
          if (calls++ != n) return 0;
          failed = call;
          return EIO;
        });
        errors = write(new_text);
      }
      if (calls <= n) break;
      const std::string where = "state " + std::to_string(static_cast<int>(before)) + ", call " + std::to_string(n);
      const std::string old = before == Before::kNothing ? "" : old_text;
      const std::string result = program_.read("made/o/stress.json"), trace = program_.read("made/t/trace.json");
      EXPECT_THAT(result, testing::AnyOf("", old, new_text)) << where;
      EXPECT_THAT(trace, testing::AnyOf(old, new_text)) << where;
      if (!result.empty()) {
        EXPECT_EQ(program_.read("made/o/stress.html"), result) << where << ": what belongs to a result is there";
      }
      if (errors.empty()) {
        EXPECT_EQ(result, new_text) << where;
        EXPECT_EQ(trace, new_text) << where;
      } else {
        EXPECT_THAT(errors, testing::AnyOf(HasSubstr(here("made/o")), HasSubstr(here("made/t")))) << where;
        EXPECT_THAT(errors, testing::Not(HasSubstr(".carousel-"))) << where;
      }
      if (before == Before::kResultsAndMore) {
        EXPECT_EQ(program_.read("made/o/notes.txt"), "mine") << where;
      }
      if (failed == Call::kRemove) {
        ASSERT_EQ(write(new_text), "");  // the next run removes what could not be removed
      }
      if (fs::exists(here("made"))) {
        EXPECT_THAT(hidden_in(here("made")), testing::IsEmpty()) << where;
      }
    }
}

TEST_F(RunOutputs, NeedNoLocks) {
  const files::FaultScope no_locks([](Call call, const fs::path&) { return call == Call::kLock ? ENOSYS : 0; });
  EXPECT_EQ(write("one"), "");
  EXPECT_EQ(write("two"), "");
  EXPECT_EQ(program_.read("made/o/stress.json"), "two");
  EXPECT_THAT(hidden_in(here("made")), testing::IsEmpty());
}

TEST_F(RunOutputs, ARunOfAnotherHostIsLeftAlone) {
  fs::create_directory(here(".o.carousel-elsewhere.1.0"));
  EXPECT_EQ(run({}).status, 0);
  EXPECT_TRUE(fs::exists(here(".o.carousel-elsewhere.1.0")));
}

TEST_F(RunOutputs, AFullDiskForAFileOfAnOptionCostsNoResult) {
  for (const char* option : {"--trace", "--dump-rays", "--dump-trees", "--dump-memory", "--log-file"}) {
    fs::remove_all(here("o"));
    const Outcome outcome = run({option, "/dev/full", "--hits"});
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_THAT(outcome.err,
                HasSubstr(std::string("error: ") + option + ": cannot write /dev/full: No space left on device"));
    EXPECT_THAT(outcome.out, HasSubstr("files        o"));
    for (const char* name : {"report.json", "image.png", "hits.csv"}) EXPECT_TRUE(fs::exists(here("o") + "/" + name));
  }
}

TEST_F(RunOutputs, AreTriedBeforeTheRunAndAreFilesOfTheirOwn) {
  program_.write("file", "");
  for (const char* option : {"--trace", "--dump-rays", "--dump-trees", "--dump-memory"}) {
    const Outcome outcome = run({option, "file/x", "--set", "scene={file: missing.glb}"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(std::string("error: ") + option + ": cannot write file/x: Not a directory"));
    EXPECT_THAT(run({option, "o/report.json"}).err,
                HasSubstr(std::string(option) + ": found o/report.json, which is a file of --out; expected a file of"));
  }
  EXPECT_THAT(run({"--trace", "x/../t", "--dump-rays", "t"}).err,
              HasSubstr("--dump-rays: found t, which is the file of --trace; expected a file of its own"));
  EXPECT_FALSE(fs::exists(here("o")));
  EXPECT_EQ(run({"--dump-rays", "o/rays.csv", "--trace", "o/deep/trace.json"}).status, 0);
  EXPECT_THAT(program_.read("o/rays.csv"), testing::ContainsRegex("\n# rows: [0-9]+\n$"));
  EXPECT_TRUE(fs::exists(here("o/deep/trace.json")));
  EXPECT_TRUE(fs::exists(here("o/report.json")));
}

TEST_F(RunOutputs, LeftOversOfAKilledRunDisappearWithTheNext) {
  const std::vector<std::string> options{"--trace", "t.json", "--dump-rays", "r.csv", "--dump-memory", "m.csv"};
  std::vector<std::string> words{"run", "a.yaml", "--out", "o", "--set", "image.samples=4000"};
  words.insert(words.end(), options.begin(), options.end());
  const pid_t pid = program_.start(words);
  for (int i = 0; i < 2000 && hidden_in(program_.folder()).size() < 4; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  kill(pid, SIGKILL);
  program_.wait(pid);
  EXPECT_EQ(hidden_in(program_.folder()).size(), 4u);
  EXPECT_EQ(run(options).status, 0);
  EXPECT_THAT(hidden_in(program_.folder()), testing::IsEmpty());
}

TEST_F(RunOutputs, ALogEndsWithTheStatus) {
  EXPECT_EQ(run({"--log-file", "log.txt"}).status, 0);
  EXPECT_TRUE(program_.read("log.txt").ends_with(" info: the program ends with status 0\n"));
  EXPECT_EQ(run({"--log-file", "log.txt", "--set", "image.width=-1"}).status, 2);
  EXPECT_TRUE(program_.read("log.txt").ends_with(" info: the program ends with status 2\n"));
}

}  // namespace
}  // namespace carousel::run_outputs_test

// Messages on the way, and messages in place of aborts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "tests/app/support/program.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::log_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const char* const kSmall =
    "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n"
    "engine: {kind: cycle}\ntopology: {resources: 2}\n";

TEST(Log, SaysNothingByItself) {
  const Program program;
  program.write("a.yaml", kSmall);
  EXPECT_THAT(program.run({"run", "a.yaml"}).err, IsEmpty());
}

TEST(Log, NamesThePhasesWithTheirTimes) {
  const Program program;
  program.write("a.yaml", kSmall);
  const Outcome outcome = program.run({"run", "a.yaml", "--log-level", "info"});
  ASSERT_EQ(outcome.status, 0);
  for (const char* phase : {"scene: ", "build: ", "run: ", "search: ", "files: "})
    EXPECT_THAT(outcome.err, HasSubstr(std::string("info: ") + phase));
  EXPECT_THAT(outcome.err, testing::ContainsRegex("run: [0-9.]+ m?s, cycle engine, [0-9.]+ k rays"));
  EXPECT_THAT(outcome.err, Not(HasSubstr("debug")));
  // Of 192 paths no pilot is made: a search would take longer than the run.
  EXPECT_THAT(program
                  .run({"run", "a.yaml", "--log-level", "debug", "--out", "b", "--set", "rays.slots_per_resource=4",
                        "--set", "image.width=80", "--set", "image.height=56", "--set", "image.max_depth=1"})
                  .err,
              AllOf(HasSubstr("debug: threads: "), HasSubstr("debug: memory: about "), HasSubstr("run begins"),
                    HasSubstr("debug: machine: 2 resources, shape ring, 2 links"), HasSubstr("debug: flow: credits"),
                    HasSubstr("deadlock impossible"), HasSubstr("debug: collections: places for "),
                    HasSubstr("debug: traversal: "), HasSubstr("debug: search: simulated ")));
}

TEST(Log, GoesToAFile) {
  const Program program;
  program.write("a.yaml", kSmall);
  const Outcome outcome = program.run({"run", "a.yaml", "--log-file", "log.txt", "--log-level", "debug"});
  ASSERT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(program.read("log.txt"), AllOf(HasSubstr("info: run: "), HasSubstr("debug: threads: ")));
  EXPECT_THAT(program.read("log.txt"), testing::ContainsRegex("20[0-9]+-[0-9]+-[0-9]+ [0-9:.]+ info: build: "));
  const Outcome refused = program.run({"run", "a.yaml", "--log-file", "no/such/folder/log.txt/"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("error: --log-file: cannot write"));
  EXPECT_EQ(program.run({"run", "a.yaml", "--log-level", "loud"}).status, 2);
}

TEST(Log, NamesRestartsAndFaults) {
  const Program program;
  program.write("a.yaml", kSmall);
  const Outcome stop =
      program.run({"run", "a.yaml", "--log-level", "info", "--set", "engine.what_if=false", "--set",
                   "topology.resources=3", "--set", "faults.resource={kind: stop, number: 1, after_rays: 20}"});
  ASSERT_EQ(stop.status, 0) << stop.err;
  EXPECT_THAT(stop.err, testing::ContainsRegex("a resource stopped: [0-9]+ rays restarted"));
}

TEST(Log, NamesWhatWasMadeUp) {
  const Program program;
  scene::GltfBuilder b = scene::GltfBuilder::square();
  b.json["scenes"][0]["name"] = "\x1b[31mred";
  program.write("a.gltf", b.text());
  program.write("a.yaml", "scene: {file: a.gltf}\nimage: {width: 8, height: 8, samples: 1}\n");
  const Outcome outcome = program.run({"run", "a.yaml", "--log-level", "info"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("info: textures: "), HasSubstr("a camera fitted to it, a sun added")));
  EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("\x1b[31m")));
}

TEST(Messages, SceneThatIsNotThereIsNamedWithItsPlace) {
  const Program program;
  program.write("a.yaml", "image: {width: 8}\nscene:\n  file: none.glb\n");
  EXPECT_THAT(program.run({"run", "a.yaml"}).err,
              HasSubstr("error: a.yaml:3:9: scene.file: expected a scene file, found 'none.glb', which is not there"));
  std::filesystem::create_directory(program.folder() / "none.glb");
  EXPECT_THAT(program.run({"run", "a.yaml"}).err, HasSubstr("a.yaml:3:9: scene.file: expected a scene file, found "
                                                            "'none.glb', which is a folder"));
}

TEST(Messages, InspectPointsToABuiltInScene) {
  const Program program;
  const Outcome outcome = program.run({"inspect", "cornell"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("cornell: no such file; the built-in scene is carousel inspect builtin:cornell"));
  EXPECT_THAT(program.run({"inspect", "."}).err, HasSubstr(".: is a folder"));
  EXPECT_THAT(program.run({"inspect", "none.glb"}).err, HasSubstr("none.glb: no such file; expected a scene file, or"));
}

TEST(Messages, InspectTellsAConfigurationApart) {
  const Program program;
  for (const char* name : {"machine.yaml", "machine.yml", "machine.json"}) {
    program.write(name, "{\"scene\": {\"builtin\": \"cornell\"}}\n");
    const Outcome outcome = program.run({"inspect", name});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.out, testing::IsEmpty());
    EXPECT_THAT(outcome.err, HasSubstr(std::string(name) +
                                       ": is a configuration, by its name; expected a scene file, "
                                       "or builtin:NAME. carousel check " +
                                       name + " shows the machine"));
  }
  EXPECT_THAT(program.run({"inspect", "none.yaml"}).err, HasSubstr("none.yaml: no such file"));
}

TEST(Messages, InspectCountsWhatTheFileHas) {
  const Program program;
  program.write("a.gltf", scene::GltfBuilder::square().text());
  const Outcome table = program.run({"inspect", "a.gltf"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out,
              HasSubstr("0 materials, 0 textures, 0 images of 0 B, 0 lights, 0 cameras\nmade up      a camera "
                        "that shows the whole model (the file has none); a sun"));
  const auto json = nlohmann::json::parse(program.run({"inspect", "a.gltf", "--json"}).out);
  EXPECT_EQ(json["scene"]["cameras"], 0);
  EXPECT_EQ(json["scene"]["lights"], 0);
  EXPECT_EQ(json["made_up"]["camera"], "fitted");
  EXPECT_EQ(json["made_up"]["sun"], true);
}

TEST(Messages, ATabIsCalledATab) {
  const Program program;
  program.write("a.yaml", "scene:\n\tbuiltin: cornell\n");
  EXPECT_THAT(
      program.run({"check", "a.yaml"}).err,
      HasSubstr("error: a.yaml:2:1: a tab is used for indentation, which YAML does not allow; expected spaces"));
  program.write("a.yaml", "scene: {builtin: cornell}\nimage:\n  width: 8\n \theight: 9\n");
  EXPECT_THAT(program.run({"check", "a.yaml"}).err, HasSubstr("a.yaml:4:2: a tab is used for indentation"));
}

TEST(Messages, ABuiltInSceneIsReplacedWithItsSection) {
  const Program program;
  program.write("a.yaml", kSmall);
  EXPECT_THAT(program.run({"check", "a.yaml", "--set", "scene.file=b.glb"}).err,
              HasSubstr("found both; another scene takes the place of both with --set 'scene={file: NAME}'"));
}

TEST(Messages, NoLibraryPrintsItsOwn) {
  const Program program;
  program.write("a.yaml", kSmall);
  EXPECT_THAT(program.run({"check", "a.yaml", "--set", "engine.threads=1024"}).err, IsEmpty());
}

// With so little address space libraries cannot start their threads, before main() or later.
TEST(Messages, TooLittleAddressSpaceEndsWithAMessage) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer needs the address space";
#endif
  const Program program;
  program.write("a.yaml", kSmall);
  rlimit old{};
  getrlimit(RLIMIT_AS, &old);
  for (const rlim_t kib : {40'000, 50'000, 55'000, 60'000, 65'000, 100'000}) {
    for (const char* engine : {"engine.kind=native", "engine.kind=cycle"}) {
      const rlimit little{kib * 1024, old.rlim_max};
      setrlimit(RLIMIT_AS, &little);
      const Outcome outcome = program.run({"run", "a.yaml", "--force", "--set", "engine.threads=2", "--set", engine,
                                           "--set", "engine.what_if=false", "--set", "image.samples=1"});
      setrlimit(RLIMIT_AS, &old);
      EXPECT_TRUE(outcome.status == 0 || outcome.status == 2) << kib << " KiB: " << outcome.status << outcome.err;
      if (outcome.status != 0) {
        EXPECT_THAT(outcome.err, HasSubstr("error: ")) << kib;
      }
      if (kib == 40'000) {
        EXPECT_EQ(outcome.status, 2);
      }
    }
  }
}

}  // namespace
}  // namespace carousel::log_test

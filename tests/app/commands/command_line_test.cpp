#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::command_line_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(CommandLine, VersionNamesWhatItWasBuiltFrom) {
  const Outcome outcome = Program().run({"--version"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* part : {"carousel ", "commit ", "compiler ", "SIMD targets "})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_THAT(outcome.err, IsEmpty());
}

TEST(CommandLine, HelpNamesTheCommands) {
  const Outcome outcome = Program().run({"--help"});
  EXPECT_EQ(outcome.status, 0);
  for (const char* command : {"run", "check", "schema"}) EXPECT_THAT(outcome.out, HasSubstr(command));
  EXPECT_EQ(Program().run({"run", "--help"}).status, 0);
}

/// The options in a help text that have no description, or name neither a default nor a range nor a unit.
std::vector<std::string> undescribed_options(const std::string& help) {
  std::vector<std::string> found;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  -") || line.find("--help") != line.npos || line.find("--version") != line.npos) continue;
    std::string next;
    const std::string text = line.find("  ", 4) == line.npos && std::getline(lines, next) ? line + next : line;
    const std::size_t begin = text.find("  ", 4);
    const bool says_more = text.find("(default: ") != text.npos || text.find('=') < begin;
    if (begin == text.npos || text.size() - begin < 25 || !says_more) found.push_back(text);
  }
  return found;
}

TEST(CommandLine, HelpSaysWhatEachOptionDoesAndItsDefault) {
  EXPECT_THAT(undescribed_options("  --seed UINT  of pauses\n"), testing::SizeIs(1));
  EXPECT_THAT(undescribed_options("  --seed UINT=1               Seed of the random pauses\n"), IsEmpty());
  const Program program;
  for (const char* command : {"run", "check", "stress", "accuracy", "inspect", "compare", "follow", "schema", "sweep",
                              "completion", "report", "serve"})
    EXPECT_THAT(undescribed_options(program.run({command, "--help"}).out), IsEmpty()) << command;
}

struct BadUsage {
  std::vector<std::string> arguments;
  const char* message;
};

TEST(CommandLine, RefusesBadUsageWithTheNearestName) {
  const Program program;
  for (const BadUsage& bad : std::vector<BadUsage>{
           {{},
            "error: expected a command: run, sweep, check, stress, accuracy, inspect, compare, versus, follow, report, "
            "serve, "
            "schema, "
            "completion, man"},
           {{"rnu", "a.yaml"},
            "error: unknown command rnu; did you mean run?; known are run, sweep, check, stress, accuracy, "
            "inspect, compare, versus, follow, report, serve, schema, completion, man"},
           {{"run", "a.yaml", "--jsn"}, "error: unknown option --jsn; did you mean --json?"},
           {{"--versoin"}, "error: unknown option --versoin; did you mean --version?"},
           {{"run"}, "error: config is required"},
           {{"run", "a.yaml", "--set"}, "--set"},
           {{"accuracy", "--cases", "3"}, "--cases requires --certify"},
           {{"accuracy", "--certify", "--cases", "3", "--seconds", "2"}, "excludes"},
           {{"schema", "config", "--graph", "a.yaml", "--markdown"}, "--markdown excludes --graph"},
           {{"schema", "report", "--graph", "a.yaml"}, "--graph: a report names no nodes; expected schema config"},
           {{"schema", "config", "--graph", "none.yaml"}, "none.yaml"},
           {{"schema", "repot"}, "repot not in {config,report}"}}) {
    const Outcome outcome = program.run(bad.arguments);
    EXPECT_EQ(outcome.status, 2) << bad.message;
    EXPECT_THAT(outcome.err, HasSubstr(bad.message));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
}

TEST(CommandLine, PrintsSchemas) {
  const Program program;
  for (const char* file : {"config", "report"}) {
    const Outcome outcome = program.run({"schema", file});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["$schema"], "https://json-schema.org/draft/2020-12/schema");
  }
  EXPECT_THAT(program.run({"schema", "config", "--markdown"}).out, HasSubstr("| `image.width` |"));
  EXPECT_THAT(program.run({"schema", "report", "--markdown"}).out, HasSubstr("| `rays.emitted` | rays |"));
}

TEST(CommandLine, PrintsTheSchemaOfAGraph) {
  const Program program;
  const Outcome outcome =
      program.run({"schema", "config", "--graph", CAROUSEL_SOURCE_DIR "/configs/packet_processes.yaml"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto links = nlohmann::json::parse(outcome.out)["properties"]["topology"]["properties"]["links"];
  EXPECT_THAT(links["items"]["properties"]["from"]["anyOf"][0]["enum"].dump(), HasSubstr("\"unit[*]\",\"dram[*]\""));
  program.write("ring.yaml", "scene: {builtin: cornell}\ntopology: {shape: ring}\n");
  const Outcome refused = program.run({"schema", "config", "--graph", "ring.yaml"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("ring.yaml:2:19: topology.shape: expected graph, whose nodes have names, found "
                                     "ring"));
}

}  // namespace
}  // namespace carousel::command_line_test

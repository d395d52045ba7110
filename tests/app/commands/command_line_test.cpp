#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel {
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

struct BadUsage {
  std::vector<std::string> arguments;
  const char* message;
};

TEST(CommandLine, RefusesBadUsageWithTheNearestName) {
  const Program program;
  for (const BadUsage& bad :
       std::vector<BadUsage>{{{}, "error: expected a command: run, check, stress, accuracy, inspect, compare, schema"},
                             {{"rnu", "a.yaml"},
                              "error: unknown command rnu; did you mean run?; known are run, check, stress, accuracy, "
                              "inspect, compare, schema"},
                             {{"run", "a.yaml", "--jsn"}, "error: unknown option --jsn; did you mean --json?"},
                             {{"--versoin"}, "error: unknown option --versoin; did you mean --version?"},
                             {{"run"}, "error: config is required"},
                             {{"run", "a.yaml", "--set"}, "--set"},
                             {{"accuracy", "--cases", "3"}, "--cases requires --certify"},
                             {{"accuracy", "--certify", "--cases", "3", "--seconds", "2"}, "excludes"},
                             {{"schema", "repot"}, "repot not in {config,report}"},
                             {{"schema", "report", "--markdown"}, "error: --markdown goes with schema config only"}}) {
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
}

}  // namespace
}  // namespace carousel

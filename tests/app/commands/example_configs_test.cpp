// Every configuration of configs/ and its folders runs, on a small picture of a small scene.
#include "tests/app/support/example_configs.h"

#include <algorithm>
#include <filesystem>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::example_configs_test {
namespace {

namespace fs = std::filesystem;

class ExampleConfigs : public testing::TestWithParam<fs::path> {};

TEST_P(ExampleConfigs, Run) {
  const Program program;
  std::vector<std::string> arguments{"run", GetParam().string(), "--json", "--quiet", "--no-html", "--out", "out"};
  const std::vector<std::string>& small = small_picture();
  add_sets(arguments, small);
  const bool traffic = has_traffic(GetParam());
  if (traffic) arguments.insert(arguments.end(), {"--set", "workload.traffic.packets=1000"});
  const bool surfaces = GetParam().filename() != "gaussians.yaml";  // the reference knows nothing else
  if (!traffic && surfaces) arguments.insert(arguments.end(), {"--set", "verify=reference"});
  const Outcome outcome = program.run(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::ordered_json::parse(outcome.out);
  for (const auto& key : report["ignored_keys"])
    EXPECT_TRUE(std::any_of(small.begin(), small.end(),
                            [&](const std::string& set) { return set.starts_with(key.get<std::string>() + "="); }))
        << key << " is set and does nothing";
  if (traffic || !surfaces) return;
  EXPECT_GE(report["rays"]["completed"], 12 * 8);
  EXPECT_EQ(report["verify"]["mismatches"], 0);
}

TEST_P(ExampleConfigs, NameTheirSchemaAndStandInTheList) {
  std::smatch schema;
  const std::string text = text_of(GetParam());
  ASSERT_TRUE(std::regex_search(
      text, schema, std::regex("^(# yaml-language-server: \\$schema=|\\{\\s*\"\\$schema\": \")(\\S+\\.json)")));
  EXPECT_TRUE(fs::equivalent(GetParam().parent_path() / schema[2].str(), CAROUSEL_SOURCE_DIR "/configs/schema.json"));
  EXPECT_THAT(text_of(CAROUSEL_SOURCE_DIR "/configs/README.md"),
              testing::HasSubstr("| `" + name_in_configs(GetParam()) + "` |"));
}

INSTANTIATE_TEST_SUITE_P(All, ExampleConfigs, testing::ValuesIn(example_configs()), example_name);

}  // namespace
}  // namespace carousel::example_configs_test

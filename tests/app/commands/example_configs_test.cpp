// Every configuration of configs/ and its folders runs, on a small picture of a small scene.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::example_configs_test {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> example_configs() {
  std::set<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(CAROUSEL_SOURCE_DIR "/configs"))
    if (const fs::path& path = entry.path();
        (path.extension() == ".yaml" || path.extension() == ".json") && path.filename() != "schema.json")
      found.insert(path);
  return {found.begin(), found.end()};
}

std::string name_of(const testing::TestParamInfo<fs::path>& file) {
  return std::regex_replace(fs::relative(file.param, CAROUSEL_SOURCE_DIR "/configs").string(), std::regex("\\W"), "_");
}

class ExampleConfigs : public testing::TestWithParam<fs::path> {};

TEST_P(ExampleConfigs, Run) {
  const Program program;
  std::vector<std::string> arguments{"run", GetParam().string(), "--json", "--quiet", "--no-html", "--out", "out"};
  const std::vector<std::string> small{"engine.what_if=false", "image.width=12",    "image.height=8",
                                       "image.samples=1",      "image.max_depth=2", "scene.triangles=1000",
                                       "scene.instances=50"};
  for (const std::string& set : small) arguments.insert(arguments.end(), {"--set", set});
  const bool traffic = text_of(GetParam()).find("traffic:") != std::string::npos;
  if (traffic) arguments.insert(arguments.end(), {"--set", "workload.traffic.packets=1000"});
  if (!traffic) arguments.insert(arguments.end(), {"--set", "verify=reference"});
  const Outcome outcome = program.run(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::ordered_json::parse(outcome.out);
  for (const auto& key : report["ignored_keys"])
    EXPECT_TRUE(std::any_of(small.begin(), small.end(),
                            [&](const std::string& set) { return set.starts_with(key.get<std::string>() + "="); }))
        << key << " is set and does nothing";
  if (traffic) return;
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
              testing::HasSubstr("| `" + fs::relative(GetParam(), CAROUSEL_SOURCE_DIR "/configs").string() + "` |"));
}

INSTANTIATE_TEST_SUITE_P(All, ExampleConfigs, testing::ValuesIn(example_configs()), name_of);

}  // namespace
}  // namespace carousel::example_configs_test

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/config_page.h"
#include "core/config/load/load.h"
#include "core/config/not_built.h"
#include "core/config/schema.h"
#include "core/config/write.h"
#include "tests/core/config/config_issues.h"
#include "tests/core/config/random_config.h"
#include "tests/support/json_schema_check.h"

namespace carousel {
namespace {

using Json = nlohmann::ordered_json;

TEST(ConfigSchema, AcceptsResolvedConfigs) {
  const Json schema = config_schema();
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    EXPECT_EQ(schema_problems(schema, config_json(random_config(seed))), std::vector<std::string>{}) << seed;
}

TEST(ConfigSchema, RefusesWhatTheParserRefuses) {
  const Json schema = config_schema();
  const Json good = config_json(parse_config("scene: {builtin: cornell}", "a"));
  ASSERT_TRUE(schema_problems(schema, good).empty());
  const auto refused = [&](const char* pointer, Json value) {
    Json bad = good;
    bad[Json::json_pointer(pointer)] = std::move(value);
    return !schema_problems(schema, bad).empty();
  };
  EXPECT_TRUE(refused("/image/width", 0));
  EXPECT_TRUE(refused("/image/width", "8"));
  EXPECT_TRUE(refused("/camera/focus_distance", 0.0));
  EXPECT_TRUE(refused("/topology/shape", "rign"));
  EXPECT_TRUE(refused("/engine/threads", "many"));
  EXPECT_TRUE(refused("/image/widht", 5));
  EXPECT_TRUE(refused("/workload", "ray"));
  EXPECT_TRUE(refused("/scene/file", "both.glb"));
  EXPECT_FALSE(refused("/testers/box", 3));
  EXPECT_FALSE(refused("/engine/threads", 3));
}

TEST(ConfigSchema, DefaultsAreThoseOfTheStructs) {
  const Json schema = config_schema();
  const Json defaults = config_json(Config{});
  EXPECT_EQ(schema["properties"]["image"]["properties"]["width"]["default"], defaults["image"]["width"]);
  EXPECT_EQ(schema["properties"]["collections"]["properties"]["policy"]["default"], "nearest");
  EXPECT_EQ(schema["properties"]["image"]["properties"]["width"]["unit"], "pixels");
}

TEST(ConfigSchema, EveryKeyHasAMeaning) {
  const std::string table = config_markdown();
  EXPECT_EQ(table.find("|  |\n"), std::string::npos);
  EXPECT_NE(
      table.find("| `packets.rays` | 1 to 1024 | 32 | rays | The largest number of ray IDs that a packet carries. |"),
      std::string::npos)
      << table;
}

TEST(ConfigSchema, SaysWhichEngineTakesAValue) {
  const Json schema = config_schema();
  const Json& topology = schema["properties"]["topology"]["properties"];
  EXPECT_EQ(topology["shape"]["engines"]["bus"], Json::array({"cycle"}));
  EXPECT_EQ(topology["shape"]["engines"]["central"], Json::array({"cycle"}));
  EXPECT_FALSE(topology["shape"]["engines"].contains("ring"));
  EXPECT_EQ(topology["link"]["properties"]["queue"]["engines"]["mutex"], Json::array({"native"}));
}

// Every row of the table names a key, and a value that the key takes; its refusal names both.
TEST(NotBuilt, EveryRowIsRefusedByName) {
  for (const NotBuilt& row : not_built()) {
    const std::string key(row.key);
    std::vector<std::string> values{std::string(row.value)};
    if (row.value.empty()) values = config::enum_values(key);
    if (values.empty()) values = {key == "sampling.fraction" ? "0.5" : "16"};
    for (const std::string& value : values) {
      for (const auto& [engine, name] : kEnumNames<EngineKind>) {
        const auto found =
            texts(issues_of("scene: {builtin: cornell}\n", {"engine.kind=" + std::string(name), key + "=" + value}));
        const auto having = config::engines_with(key, value);
        const bool has = std::find(having.begin(), having.end(), engine) != having.end();
        const std::string begin = "--set " + key + "=" + value + ": " + key + ": ";
        const bool refused = std::any_of(found.begin(), found.end(), [&](const std::string& text) {
          return text.starts_with(begin) &&
                 (text.find("is not built yet; expected ") != text.npos || text.find("engine has no ") != text.npos);
        });
        EXPECT_EQ(refused, !has) << key << ": " << value << ", " << name << ": " << testing::PrintToString(found);
      }
    }
  }
}

TEST(ConfigSchema, StandsBesideTheExamples) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/configs/schema.json");
  const std::string kept{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(kept == config_schema().dump(2) + "\n") << "carousel schema config >configs/schema.json";
}

// The pages of docs/reference/config have these rows (tests/install/docs_test.py).
TEST(ConfigPage, HasARowForEachKeyOfAConfiguration) {
  const std::string page = config_markdown();
  const auto look = [&](const auto& self, const std::string& path, const Json& value) -> void {
    if (value.is_object() && !value.empty()) {
      for (const auto& [key, below] : value.items()) self(self, path.empty() ? key : path + "." + key, below);
      return;
    }
    std::string start = "\n| `" + path + "` | ";
    if (value.is_object() && page.find(start) == std::string::npos) start = "\n| `" + path + ".NAME` | ";  // a map
    const std::size_t row = page.find(start);
    ASSERT_NE(row, std::string::npos) << path;
    EXPECT_EQ(page.find(start, row + 1), std::string::npos) << path;
  };
  look(look, "", config_json(parse_config("scene: {builtin: cornell}", "a")));
}

}  // namespace
}  // namespace carousel

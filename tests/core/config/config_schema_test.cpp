#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/load.h"
#include "core/config/schema.h"
#include "core/config/write.h"
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
  EXPECT_NE(table.find("| `packets.rays` | 1 to 1024 | 32 | rays | ray IDs a packet carries at most |"),
            std::string::npos)
      << table;
}

}  // namespace
}  // namespace carousel

#include <algorithm>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/config/config_page.h"
#include "core/config/graph/graph.h"
#include "core/config/graph/names_in_schema.h"
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

/// A graph with a group of 12, single nodes, and routers, which own no rays.
const char* const kDrawing =
    "scene: {builtin: cornell}\nengine: {kind: cycle}\nclocks: {slow: 700}\ntopology:\n  shape: graph\n  nodes:\n"
    "    - {name: r, count: 12}\n    - {name: one}\n    - {name: x, kind: router, count: 1}\n    - {name: hub, kind: "
    "router}\n  links:\n    - {ring: 'r[*], one, x[0]', clock: slow}\n    - {from: 'r[*], one', to: hub, both: true}\n";

Json drawn_schema(const Config& config) {
  Json schema = config_schema();
  config::name_in_schema(schema, config.topology, config.clocks);
  return schema;
}

// The keys take what finds nodes in the graph, and nothing else: the patterns are those of NodeNames.
TEST(ConfigSchema, OfAGraphTakesItsNames) {
  const Config config = parse_config(kDrawing, "a");
  const Json schema = drawn_schema(config), topology = schema["properties"]["topology"]["properties"];
  EXPECT_EQ(schema_problems(schema, config_json(config)), std::vector<std::string>{});
  std::vector<config::GraphIssue> issues;
  const config::Graph graph = config::draw_graph(config.topology, issues);
  std::vector<std::string> texts{"",       "r[12]",  "r[-1]",    "r[*",     "r*]",     "r[]",  "r[0..]",
                                 "r[..3]", "r[1.3]", "r[0..12]", "one[0]",  "x",       "x[1]", "r",
                                 "q[0]",   "ro",     "rr[0]",    "one one", "r[1] one"};
  for (int i = 0; i < 12; ++i) {
    texts.push_back("r[" + std::to_string(i) + "]");
    texts.push_back("r[" + std::to_string(11 - i) + ".." + std::to_string(i) + "]");
    texts.push_back("r[0" + std::to_string(i) + "]");
    texts.push_back("r[" + std::to_string(i) + "..0" + std::to_string(i) + "]");
  }
  for (const char* text : {"r[*]", "one", "x[0]", "x[*]", "x[0..0]", "hub"}) texts.push_back(text);
  const std::size_t single = texts.size();
  for (std::size_t i = 0; i < single; ++i)
    for (const char* more : {", one", ",r[3..1] ,hub", ", ", ",,one", " ,x[0]"}) texts.push_back(texts[i] + more);
  std::size_t taken = 0;
  for (const std::string& text : texts) {
    SCOPED_TRACE(text);
    std::string error;
    const std::vector<std::uint32_t> nodes = graph.names.find(text, error);
    const auto takes = [&](const Json& key) { return schema_problems(key, text).empty(); };
    for (const char* key : {"from", "to", "all_to", "ring", "line", "of"})
      EXPECT_EQ(takes(topology["links"]["items"]["properties"][key]), !nodes.empty()) << key;
    const bool own = !nodes.empty() && std::ranges::all_of(nodes, [](std::uint32_t node) { return node < 13; });
    EXPECT_EQ(takes(topology["nodes"]["items"]["properties"]["serves"]), own);
    EXPECT_EQ(takes(topology["overrides"]["items"]["properties"]["nodes"]), own);
    EXPECT_EQ(takes(topology["root"]), nodes.size() == 1);
    EXPECT_EQ(takes(topology["ways"]["items"]["properties"]["next"]), nodes.size() == 1);
    taken += !nodes.empty();
  }
  EXPECT_GT(taken, 100u);
  EXPECT_LT(taken, texts.size() - 50);
}

TEST(ConfigSchema, OfAGraphListsWhatAnEditorCompletes) {
  const Json topology = drawn_schema(parse_config(kDrawing, "a"))["properties"]["topology"]["properties"];
  const Json from = topology["links"]["items"]["properties"]["from"];
  EXPECT_EQ(from["anyOf"][0]["enum"].dump().substr(0, 31), R"(["r[*]","x[*]","r[0]","r[1]","r)");
  EXPECT_EQ(
      from["description"],
      config_schema()["properties"]["topology"]["properties"]["links"]["items"]["properties"]["from"]["description"]);
  EXPECT_EQ(topology["links"]["items"]["properties"]["clock"]["enum"], Json({"core", "noc", "slow"}));
  const Json serves = topology["nodes"]["items"]["properties"]["serves"]["anyOf"][0]["enum"];
  EXPECT_EQ(serves.size(), 14u);  // twelve of the group, the group and the single resource
  for (const std::string& name : serves.get<std::vector<std::string>>()) EXPECT_NE(name[0], 'h');
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

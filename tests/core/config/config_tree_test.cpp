#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/tree/tree.h"
#include "tests/core/config/config_issues.h"

namespace carousel {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> json_issues(const std::string& text) {
  return texts(issues_of(text, {}, "test.json"));
}

config::Node tree(const std::string& text, const std::string& name) {
  std::vector<ConfigIssue> issues;
  return config::parse_tree(text, name, issues);
}

TEST(ConfigTree, JsonSurrogatePairsMakeOneCharacter) {
  const Config config = parse_config(R"({"scene": {"file": "\ud83c\udfa0.glb"}})", "test.json");
  EXPECT_EQ(config.scene.file, "\xf0\x9f\x8e\xa0.glb");
}

TEST(ConfigTree, JsonIsRecognisedWithoutItsSuffix) {
  EXPECT_EQ(parse_config(R"( {"scene": {"file": "\ud83c\udfa0"}})", "test").scene.file, "\xf0\x9f\x8e\xa0");
}

TEST(ConfigTree, ABraceAloneDoesNotMakeJson) {
  EXPECT_EQ(parse_config("{scene: {builtin: cornell}, image: {width: 4}}", "test").image.width, 4);
}

TEST(ConfigTree, JsonValuesHavePositions) {
  const config::Node root = tree("{\"a\": [1, -2.5e3,\n \"x\\\"y\\\\\", null],\n  \"b\"  :{\"c\":true}}", "t.json");
  const auto at = [](const config::Node& node) { return node.position.text(); };
  EXPECT_EQ(at(root), "t.json:1:1");
  EXPECT_EQ(at(root.find("a")->items[0]), "t.json:1:8");
  EXPECT_EQ(at(root.find("a")->items[1]), "t.json:1:11");
  EXPECT_EQ(at(root.find("a")->items[2]), "t.json:2:2");
  EXPECT_EQ(root.find("a")->items[2].text, "x\"y\\");
  EXPECT_EQ(at(root.find("a")->items[3]), "t.json:2:12");
  EXPECT_EQ(root.members[1].key_position.text(), "t.json:3:3");
  EXPECT_EQ(at(*root.find("b")->find("c")), "t.json:3:14");
}

TEST(ConfigTree, JsonErrorsHavePositions) {
  EXPECT_THAT(json_issues("{\"scene\": {\"builtin\": \"cornell\"},\n \"image\": {\"width\": 0}}"),
              ElementsAre("test.json:2:21: image.width: expected an integer from 1 to 16384 (pixels), found 0"));
  EXPECT_THAT(json_issues("{\"scene\": {\"builtin\": \"cornell\"},\n \"scene\": {}}"),
              ElementsAre("test.json:2:2: scene: duplicate key; first given at line 1, column 2"));
  EXPECT_THAT(json_issues("{\"scene\":\n  {\"builtin\" \"cornell\"}}"),
              ElementsAre(HasSubstr("test.json:2:22: syntax error while parsing object separator")));
  EXPECT_THAT(json_issues("{\"scene\": 1e999}"), ElementsAre(HasSubstr("test.json:1:15: number overflow")));
  EXPECT_THAT(json_issues(""), ElementsAre(HasSubstr("test.json:1:1: syntax error")));
}

TEST(ConfigTree, JsonTextAfterTheObjectIsAnError) {
  EXPECT_THAT(json_issues("{\"scene\": {\"builtin\": \"cornell\"}} {}"),
              ElementsAre(HasSubstr("test.json:1:35: syntax")));
}

TEST(ConfigTree, YamlScalarsFollowTheCoreSchema) {
  const config::Node root =
      tree("[~, null, true, no, 0o17, +3, -0x1, 1., .5, 1e3, .inf, -.inf, 1_000, 1.2.3, '1', \"\"]", "t");
  using K = config::Node::Kind;
  std::vector<K> kinds;
  for (const config::Node& item : root.items) kinds.push_back(item.kind);
  EXPECT_THAT(kinds,
              ElementsAre(K::kNull, K::kNull, K::kBool, K::kString, K::kInt, K::kInt, K::kInt, K::kFloat, K::kFloat,
                          K::kFloat, K::kFloat, K::kFloat, K::kString, K::kString, K::kString, K::kString));
  EXPECT_EQ(root.items[4].text, "15");
  EXPECT_EQ(root.items[6].text, "-1");
}

TEST(ConfigTree, DeepNestingIsAnErrorAndNoCrash) {
  const std::string open(200'000, '['), json_open = "{\"scene\": " + open;
  EXPECT_THAT(texts(issues_of("a: " + open + std::string(open.size(), ']'))),
              ElementsAre(HasSubstr("nested more than 32 deep")));
  EXPECT_THAT(json_issues(json_open), ElementsAre("test.json:1:42: nested more than 32 deep"));
  std::string keys;
  for (int i = 0; i < 5000; ++i) keys += "{a: ";
  EXPECT_THAT(texts(issues_of(keys + std::string(5000, '}'))), ElementsAre(HasSubstr("nested more than 32 deep")));
  std::string path = "a";
  for (int i = 0; i < 5000; ++i) path += ".a";
  EXPECT_FALSE(issues_of("scene: {builtin: cornell}", {path + "=1"}).empty());
}

TEST(ConfigTree, AliasesCannotExplode) {
  std::string text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int j = 0; j < 10; ++j) text += last + ", ";
    text += "]\n";
  }
  EXPECT_THAT(texts(issues_of(text)), ElementsAre(HasSubstr("more than 32768 values, aliases expanded")));
}

TEST(ConfigTree, LargeFilesAreRefused) {
  EXPECT_THAT(texts(issues_of(std::string((1 << 20) + 1, ' '))), ElementsAre("test.yaml: larger than 1048576 bytes"));
}

TEST(ConfigTree, AByteOrderMarkIsSkipped) {
  EXPECT_TRUE(issues_of("\xef\xbb\xbfscene: {builtin: cornell}\n").empty());
  EXPECT_TRUE(json_issues("\xef\xbb\xbf{\"scene\": {\"builtin\": \"cornell\"}}\n").empty());
}

TEST(ConfigTree, LongTextsAreCutInMessages) {
  EXPECT_THAT(texts(issues_of("scene: {builtin: cornell}\nimage: " + std::string(3000, 'x'))),
              ElementsAre("test.yaml:2:8: image: expected a map, found '" + std::string(60, 'x') + "...'"));
}

}  // namespace
}  // namespace carousel

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::report_command_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kConfig =
    "schema_version: 1\nscene: {builtin: spheres, triangles: 500}\nimage: {width: 8, height: 8, samples: 1}\n"
    "engine: {kind: cycle, what_if: false}\ntopology: {resources: 3}\n";

class RunPage : public testing::Test {
 protected:
  RunPage() { program_.write("small.yaml", kConfig); }
  Outcome run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"run", "small.yaml", "--quiet", "--out", "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return program_.run(arguments);
  }
  bool exists(const char* name) const { return std::filesystem::exists(program_.folder() / name); }

  Program program_;
};

TEST_F(RunPage, IsWrittenByRunAndMadeAgainByReport) {
  ASSERT_EQ(run({}).status, 0);
  const std::string page = program_.read("out/report.html");
  EXPECT_THAT(page, HasSubstr("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
  std::filesystem::remove(program_.folder() / "out/report.html");
  const Outcome again = program_.run({"report", "out"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(program_.read("out/report.html"), page);
}

TEST_F(RunPage, OfAllResultsOfAFolderAreMadeAgain) {
  ASSERT_EQ(run({}).status, 0);
  const Outcome accuracy = program_.run(
      {"accuracy", "small.yaml", "--rays", "30", "--hard-rays", "10", "--repetitions", "1", "--quiet", "--out", "out"});
  ASSERT_EQ(accuracy.status, 0) << accuracy.err;
  std::filesystem::remove(program_.folder() / "out/report.html");
  std::filesystem::remove(program_.folder() / "out/accuracy.html");
  const Outcome again = program_.run({"report", "out"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(exists("out/report.html"));
  EXPECT_TRUE(exists("out/accuracy.html"));
  const Outcome one = program_.run({"report", "out", "--out", "page.html"});
  EXPECT_EQ(one.status, 2);
  EXPECT_THAT(one.err, HasSubstr("2 results are in this folder"));
  std::filesystem::create_directory(program_.folder() / "empty");
  const Outcome none = program_.run({"report", "empty"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("sweep.json, report.json, accuracy.json, stress.json or versus.json"));
}

TEST_F(RunPage, IsLeftOutOnRequest) {
  ASSERT_EQ(run({"--no-html"}).status, 0);
  EXPECT_TRUE(exists("out/report.json"));
  EXPECT_FALSE(exists("out/report.html"));
}

TEST_F(RunPage, ShowsTheNumbersOfTheReportInItsTables) {
  ASSERT_EQ(run({}).status, 0);
  const auto report = nlohmann::json::parse(program_.read("out/report.json"));
  const std::string page = program_.read("out/report.html");
  for (const auto& resource : report["resources"])
    EXPECT_THAT(page, HasSubstr(" data-v=\"" + resource["box_tests"].dump() + "\""));
  EXPECT_THAT(page, HasSubstr(report["digest"]["hits"].get<std::string>()));
}

TEST_F(RunPage, TextOfAReportIsNoMarkup) {
  ASSERT_EQ(run({}).status, 0);
  auto report = nlohmann::ordered_json::parse(program_.read("out/report.json"));
  report["scene"]["name"] = "<script>alert(1)</script>";
  report["time_series"]["rows"][0]["quantity"] = "</script><b>";
  report["time_series"]["rows"][0]["unit"] = "\"><img src=x onerror=alert(1)>";
  report.erase("checksum");
  program_.write("out/report.json", report.dump());
  ASSERT_EQ(program_.run({"report", "out"}).status, 0);
  const std::string page = program_.read("out/report.html");
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(1)"));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert(1)")));
  EXPECT_THAT(page, Not(HasSubstr("</script><b>")));
  EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
}

TEST_F(RunPage, OfAReportWithoutItsShapeIsRefused) {
  ASSERT_EQ(run({}).status, 0);
  auto report = nlohmann::ordered_json::parse(program_.read("out/report.json"));
  report["links"] = nlohmann::ordered_json::parse("[{}]");
  report.erase("checksum");
  program_.write("out/broken.json", report.dump());
  for (const auto& words :
       {std::vector<std::string>{"report", "out/broken.json"}, {"compare", "out", "out/broken.json"}}) {
    const Outcome outcome = program_.run(words);
    EXPECT_EQ(outcome.status, 2) << words[0];
    EXPECT_THAT(outcome.err, HasSubstr("out/broken.json: links[0].from: expected a whole number, found nothing"));
  }
}

TEST_F(RunPage, NeedsAReport) {
  program_.write("other.json", "{\"a\": 1}");
  const Outcome outcome = program_.run({"report", "other.json"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("other.json: expected the report.json of carousel run"));
  EXPECT_EQ(program_.run({"report", "nowhere"}).status, 2);
}

}  // namespace
}  // namespace carousel::report_command_test

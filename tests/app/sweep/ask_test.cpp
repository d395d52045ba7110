// Points from standard input, and files of a sweep that are not as they were written.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "tests/app/sweep/sweep_program.h"

namespace carousel::ask_test {
namespace {

using Json = nlohmann::ordered_json;
using testing::HasSubstr;

class SweepAsk : public testing::Test {
 protected:
  SweepAsk() { program_.write("a.yaml", std::string(kTinyMachine)); }

  /// Sends lines, and gives the answers.
  std::vector<Json> ask(const std::string& lines) {
    program_.write("lines", lines);
    const std::string command = "cd '" + program_.folder().string() +
                                "' && " CAROUSEL_BINARY " sweep a.yaml --ask --tell <lines >answers 2>errors";
    status_ = WEXITSTATUS(std::system(command.c_str()));
    errors_ = program_.read("errors");
    std::vector<Json> out;
    std::istringstream answers(program_.read("answers"));
    for (std::string line; std::getline(answers, line);) out.push_back(Json::parse(line));
    return out;
  }
  std::string error(const Json& answer) const {
    EXPECT_EQ(answer["status"], "invalid") << answer;
    return answer["error"]["text"].get<std::string>();
  }
  std::filesystem::path point_file() const {
    for (const auto& entry : std::filesystem::directory_iterator(program_.folder() / "out/a/points"))
      if (entry.path().extension() == ".json") return entry.path();
    return {};
  }

  Program program_;
  int status_ = -1;
  std::string errors_;
};

TEST_F(SweepAsk, AnswersEachLineWhateverItHolds) {
  std::string many = "{\"scene\": \"builtin:cornell\"";
  for (int i = 0; i < 200; ++i) many += ", \"shading.key_number_" + std::to_string(i) + "\": 1";
  const std::vector<Json> answers =
      ask("{\"scene\": {\"builtin\": \"cornell\"}}\n{\"scene\": \"missing.glb\"}\n[1]\n{\n"
          "{\"topology.resources\": 2, \"topology.resources\": 4}\n" +
          many + "}\n{\"qqqqqqqqqqqqqq\": 1}\n{\"topology.resources\": 2}\n");
  ASSERT_EQ(answers.size(), 8u) << errors_;
  EXPECT_THAT(error(answers[0]), HasSubstr("scene: expected a file or builtin:NAME, found an object"));
  EXPECT_THAT(error(answers[1]), HasSubstr("missing.glb"));
  EXPECT_THAT(error(answers[2]), HasSubstr("expected a JSON object"));
  EXPECT_THAT(error(answers[3]), HasSubstr("line 1, column 2"));
  EXPECT_THAT(error(answers[4]), HasSubstr("topology.resources: the key stands twice"));
  EXPECT_LT(error(answers[5]).size(), 8000u);
  EXPECT_THAT(error(answers[5]), HasSubstr("and 193 more keys"));
  EXPECT_THAT(error(answers[5]), HasSubstr("190 more errors"));
  EXPECT_LT(error(answers[6]).size(), 400u) << error(answers[6]);
  EXPECT_EQ(answers[7]["status"], "done") << answers[7];
  EXPECT_EQ(status_, 0) << errors_;
}

TEST_F(SweepAsk, BelievesNoPointThatWasChanged) {
  const std::string line = "{\"topology.resources\": 2}\n";
  const Json first = ask(line).at(0);
  ASSERT_EQ(first["status"], "done");
  const std::string good = program_.read(std::filesystem::relative(point_file(), program_.folder()));
  EXPECT_EQ(ask(line).at(0), first) << "it ran again";
  Json changed = Json::parse(good);
  changed["report"]["engine"]["cycles"] = 1;
  std::ofstream(point_file()) << changed;
  Json again = ask(line).at(0);
  EXPECT_THAT(errors_, HasSubstr("checksum: expected "));
  EXPECT_THAT(errors_, HasSubstr("its point runs again"));
  EXPECT_EQ(again["results"]["cycles"], first["results"]["cycles"]);
  changed.erase("checksum");
  std::ofstream(point_file()) << changed;
  again = ask(line).at(0);
  EXPECT_EQ(again["results"]["cycles"], first["results"]["cycles"]);
}

TEST_F(SweepAsk, MakesABrokenLedgerAnewFromThePoints) {
  ASSERT_EQ(ask("{\"topology.resources\": 2}\n").at(0)["status"], "done");
  const std::filesystem::path ledger = program_.folder() / "out/a/sweep.sqlite";
  for (const std::string& content : {std::string(4096, 'x'), std::string("SQLite format 3")}) {
    std::ofstream(ledger) << content;
    EXPECT_EQ(ask("{\"topology.resources\": 3}\n").at(0)["status"], "done");
    EXPECT_EQ(status_, 0) << errors_;
    EXPECT_THAT(errors_, HasSubstr("is made anew from the files of the points"));
    // SQLite keeps texts as they are: both points are in the file or its log.
    std::string bytes = program_.read("out/a/sweep.sqlite");
    for (const char* keys : {"{\"topology.resources\":2}", "{\"topology.resources\":3}"})
      EXPECT_THAT(bytes, HasSubstr(keys));
  }
}

}  // namespace
}  // namespace carousel::ask_test

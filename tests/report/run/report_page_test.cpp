#include "report/run/report_page.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/run/terminal_words.h"

namespace carousel::report {
namespace {

TEST(ReportPage, IsWrittenByTheProgram) {
  std::ifstream file(CAROUSEL_SOURCE_DIR "/docs/reference/report.md");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(page == report_markdown()) << "carousel schema report --markdown >docs/reference/report.md";
}

// A key that the schema does not have would have no meaning.
TEST(ReportPage, EveryItemOfTheTerminalHasAMeaning) {
  EXPECT_THAT(report_markdown(), testing::Not(testing::ContainsRegex("\\|  \\|\n")));
  for (const TerminalWord& word : terminal_words()) EXPECT_FALSE(word.key.empty() && word.meaning.empty()) << word.text;
}

TEST(ReportPage, HasKeysOfListsAndOfSections) {
  const std::string page = report_markdown();
  EXPECT_THAT(page, testing::HasSubstr("| `links[].cycles.busy` | cycles | the link moved a packet |"));
  EXPECT_THAT(page, testing::HasSubstr("| rays | N emitted | `rays.emitted` | rays emitted by shading |"));
}

}  // namespace
}  // namespace carousel::report

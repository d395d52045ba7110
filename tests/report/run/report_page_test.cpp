#include "report/run/report_page.h"

#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/run/terminal_words.h"

namespace carousel::report {
namespace {

// The page begins with the numbers to look at first, each of which it explains further down.
TEST(ReportPage, ExplainsTheTenNumbersThatItBeginsWith) {
  const std::string page = report_markdown();
  const std::size_t begin = page.find("## The ten numbers"), end = page.find("\n## ", begin + 1);
  ASSERT_LT(begin, end);
  std::size_t rows = 0;
  for (std::size_t row = page.find("\n| `", begin); row < end; row = page.find("\n| `", row + 1)) {
    ++rows;
    const std::size_t stop = page.find(" | ", row + 2);
    for (std::size_t open = page.find('`', row); open < stop; open = page.find('`', page.find('`', open + 1) + 1)) {
      const std::string key = page.substr(open, page.find('`', open + 1) - open + 1);
      EXPECT_NE(page.find("\n| " + key + " | ", end), std::string::npos) << key;
    }
  }
  EXPECT_EQ(rows, 10U);
}

// A key that the schema does not have would have no meaning.
TEST(ReportPage, EveryItemOfTheTerminalHasAMeaning) {
  EXPECT_THAT(report_markdown(), testing::Not(testing::ContainsRegex("\\|  \\|\n")));
  for (const TerminalWord& word : terminal_words()) EXPECT_FALSE(word.key.empty() && word.meaning.empty()) << word.text;
}

// A row with a bar of its own has a column too many.
TEST(ReportPage, EachRowHasTheColumnsOfItsTable) {
  std::istringstream page(report_markdown());
  std::size_t columns = 0;
  for (std::string line; std::getline(page, line);) {
    std::size_t bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
    if (line.starts_with('|') && columns > 0) {
      EXPECT_EQ(bars, columns) << line;
    }
    columns = line.starts_with('|') ? bars : 0;
  }
}

TEST(ReportPage, HasKeysOfListsAndOfSections) {
  const std::string page = report_markdown();
  EXPECT_THAT(page, testing::HasSubstr("| `links[].cycles.busy` | cycles | the link moved a packet |"));
  EXPECT_THAT(page, testing::HasSubstr("| rays | N emitted | `rays.emitted` | rays emitted by shading |"));
}

}  // namespace
}  // namespace carousel::report

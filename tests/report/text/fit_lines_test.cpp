#include "report/text/fit_lines.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "report/text/progress_line.h"

namespace carousel::report {
namespace {

TEST(FitLines, LeavesLinesThatFit) {
  const std::string text = "rays         1,234 emitted   1,234 completed\n\nend";
  EXPECT_EQ(fit_lines(text, 44), text);
  EXPECT_EQ(fit_lines("", 40), "");
  EXPECT_EQ(fit_lines("\n", 40), "\n");
}

TEST(FitLines, GoesOnBelowTheSecondColumn) {
  EXPECT_EQ(fit_lines("rays         1,234 emitted   1,234 completed   0 lost\n", 43),
            "rays         1,234 emitted   1,234\n             completed   0 lost\n");
}

TEST(FitLines, CutsWordsThatAreLongerThanALine) {
  std::istringstream lines(fit_lines("digest       " + std::string(100, 'a') + "  b", 40));
  std::size_t letters = 0;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 40u);
    letters += static_cast<std::size_t>(std::count(line.begin(), line.end(), 'a'));
  }
  EXPECT_EQ(letters, 100u);
}

TEST(FitLines, CountsCharactersNotBytes) {
  EXPECT_EQ(columns_of("\xc3\xa9t\xc3\xa9"), 3u);
  EXPECT_EQ(cut_to("\xc3\xa9t\xc3\xa9", 2), "\xc3\xa9t");
}

TEST(ProgressText, AlwaysHasARateAUnitAndAnEstimate) {
  const std::string text = progress_text(0.25, 10, 5000, "rays", "bottleneck, 2 of 9: links", 200);
  EXPECT_NE(
      text.find("[#######.......................]  25 %  bottleneck, 2 of 9: links  5 krays  500 rays/s  10.00 s"),
      text.npos)
      << text;
  EXPECT_NE(text.find("30.00 s left"), text.npos) << text;
  for (std::size_t width = 39; width < 150; ++width) {
    const std::string line = progress_text(0.25, 10, 5000, "rays", "bottleneck, 2 of 9: links", width);
    EXPECT_LT(columns_of(line), width);
    EXPECT_NE(line.find("500 rays/s"), line.npos) << line;
    EXPECT_NE(line.find(" left"), line.npos) << line;
  }
  EXPECT_NE(progress_text(0, 1, 0, "trials", "", 100).find("0 trials/s  1.00 s  time left unknown"), std::string::npos);
  EXPECT_LT(columns_of(progress_text(0.5, 10, 5000, "rays", "", 12)), 12u);
}

}  // namespace
}  // namespace carousel::report

#include "report/text/progress_line.h"

#include <array>

#include <gtest/gtest.h>

namespace carousel::report {
namespace {

TEST(ProgressLine, IsSilentWhereThereIsNoTerminal) {
  std::FILE* file = std::tmpfile();
  ASSERT_NE(file, nullptr);
  {
    ProgressLine line(file);
    EXPECT_FALSE(line.shown());
    line.update(0.5, 1000);
  }
  std::fflush(file);
  EXPECT_EQ(std::ftell(file), 0);
  std::fclose(file);
}

}  // namespace
}  // namespace carousel::report

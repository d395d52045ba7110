#include "ringbus/cycle/progress_log.h"

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

TEST(ProgressLog, EverySampleThatStaysIsWhole) {
  ProgressLog log;
  for (std::uint64_t completed = 1; completed < 100'000; ++completed)
    if (log.wants(completed)) log.add({.at = 3 * completed, .completed = completed, .busy = {completed, 7}});
  ASSERT_GT(log.samples().size(), 100u);
  EXPECT_EQ(log.samples().front().completed, 1u);
  for (const ProgressSample& sample : log.samples()) {
    EXPECT_EQ(sample.at, 3 * sample.completed);
    EXPECT_EQ(sample.busy, (std::vector<std::uint64_t>{sample.completed, 7}));
  }
}

}  // namespace
}  // namespace carousel::ringbus::cycle

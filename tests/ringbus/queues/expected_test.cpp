#include "ringbus/stress/expected.h"

#include <gtest/gtest.h>

namespace carousel::ringbus::stress {
namespace {

TEST(ExpectedProperties, ExplainTheirOwnFaultOnly) {
  Violations found;
  found.reordered = 2;
  EXPECT_NE(expected_of("atomic_queue", Pattern::kOversubscribed, found), "");
  EXPECT_EQ(expected_of("atomic_queue", Pattern::kStream, found), "");  // one producer: nobody overtakes
  EXPECT_EQ(expected_of("mpmc_ring", Pattern::kOversubscribed, found), "");
  found.lost = 1;
  EXPECT_EQ(expected_of("atomic_queue", Pattern::kOversubscribed, found), "");
  EXPECT_EQ(expected_of("atomic_queue", Pattern::kOversubscribed, {}), "");
}

}  // namespace
}  // namespace carousel::ringbus::stress

#include <gtest/gtest.h>

#include "ringbus/cycle/fabric/ports.h"

namespace carousel::ringbus::cycle {
namespace {

// A packet that waits to be injected under flow: bubble counts the free places of the next queue, and each credit may
// be the one that it waits for.
TEST(OutPort, TellsOfACreditBeforeThePacketInItsQueueMayLeave) {
  Wire wire;
  OutPort out(wire, 5, 3, 4);
  Token token;
  token.link_cycles = 20;
  out.push(token, 0, false);
  out.push(token, 0, false);
  ASSERT_TRUE(out.send(0));  // the second packet leaves in cycle 20
  wire.credits.send(7, {});
  EXPECT_EQ(out.next(true), 7u);
  EXPECT_EQ(out.next(false), 20u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle

#include <gtest/gtest.h>

#include "ringbus/cycle/fabric/ports.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

// A packet that waits to be injected under flow: bubble counts the free places of the next queue, and each credit may
// be the one that it waits for.
TEST(OutPort, TellsOfACreditBeforeThePacketInItsQueueMayLeave) {
  LooseWire wire;
  OutPort out(wire, 5, 3, 4);
  Token token;
  token.link_cycles = 20;
  out.push(token, 0, false);
  out.push(token, 0, false);
  ASSERT_TRUE(out.send(0));  // the second packet leaves in cycle 20
  wire.packets.take(7);
  EXPECT_EQ(out.next(true), 7u);
  EXPECT_EQ(out.next(false), 20u);
}

// A packet waits for a credit from the cycle in which it could have gone, whether or not anybody looked then.
TEST(OutPort, CountsTheWaitForACreditFromTheCycleInWhichThePacketCouldHaveGone) {
  for (const bool looks : {false, true}) {
    LooseWire wire;
    OutPort out(wire, 1, 1, 4);
    Token token;
    token.link_cycles = 4;
    out.push(token, 0, false);
    ASSERT_TRUE(out.send(0));  // the link is free in cycle 4
    EXPECT_EQ(out.blocked_from(), kNever);
    out.push(token, 7, false);
    EXPECT_EQ(out.blocked_from(), 7u);
    if (looks) {
      for (Cycle now = 5; now < 30; now += 3) EXPECT_FALSE(out.send(now));
    }
    wire.packets.take(30);
    out.take_credits(30);
    ASSERT_TRUE(out.send(30));
    EXPECT_EQ(out.stalled(), 23u);
  }
}

}  // namespace
}  // namespace carousel::ringbus::cycle

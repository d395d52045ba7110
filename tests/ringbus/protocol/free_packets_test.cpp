#include "ringbus/protocol/free_packets.h"

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

TEST(FreePackets, ALookCostsNoDirectionItsTurn) {
  FreePackets free(PacketId(0), 2, 3);
  EXPECT_EQ(free.front(), PacketId(2));
  EXPECT_EQ(free.front(), PacketId(2));  // however often one looks
  EXPECT_EQ(free.take(), PacketId(2));
  EXPECT_EQ(free.take(), PacketId(5));
  EXPECT_EQ(free.take(), PacketId(1));
}

}  // namespace
}  // namespace carousel::ringbus

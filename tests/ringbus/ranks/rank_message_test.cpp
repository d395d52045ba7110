#include "ringbus/ranks/rank_message.h"

#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/system/error.h"
#include "ringbus/rays/rank_share.h"

namespace carousel::ringbus {
namespace {

TEST(RankMessage, ComesBackFromItsWords) {
  Packet packet;
  packet.owner = ResourceId(3);
  packet.depth = 7;
  packet.members = {{.ray = RayIdLayout(16).make(ResourceId(2), 5), .mask = 9}};
  packet.owners = {4};
  RankMessage sent;
  sent.credits = {{2, 1'000'000'000'000}};
  sent.rays.push_back({RayIdLayout(16).make(ResourceId(1), 2), {}});
  sent.rays[0].request.tag.path = 77;
  sent.rays_taken = 12;
  sent.hungry = true;
  sent.results.push_back({ResourceId(1), 6, {}});
  sent.results[0].result.hit.t = 2.5f;
  sent.add(4, PacketId(20), Packet());
  sent.add(5, PacketId(21), packet);
  sent.token = EndToken{3, 1, 2};
  sent.farewell = Farewell{Farewell::Reason::kFault, "rank 1: broken"};
  EXPECT_EQ(sent.items(), 4u);

  std::vector<std::uint64_t> words;
  sent.write(words);
  RankMessage got;
  got.read(words);
  ASSERT_EQ(got.credits.size(), 1u);
  EXPECT_EQ(got.credits[0].taken, 1'000'000'000'000u);
  EXPECT_EQ(got.rays.at(0).request.tag.path, 77u);
  EXPECT_EQ(got.rays_taken, 12u);
  EXPECT_TRUE(got.hungry);
  EXPECT_EQ(got.results.at(0).slot, 6u);
  EXPECT_EQ(got.results.at(0).result.hit.t, 2.5f);
  EXPECT_EQ(got.token, sent.token);
  EXPECT_EQ(got.farewell, sent.farewell);
  ASSERT_EQ(got.packets.size(), 2u);
  EXPECT_EQ(got.packets[1].wire, 5u);
  Packet back;
  got.restore_packet(1, back);
  EXPECT_EQ(back.owner, ResourceId(3));
  EXPECT_EQ(back.depth, 7);
  ASSERT_EQ(back.members.size(), 1u);
  EXPECT_EQ(back.members[0].ray.bits, packet.members[0].ray.bits);
  EXPECT_EQ(back.members[0].mask, 9);
  EXPECT_EQ(back.owners, packet.owners);
}

TEST(RankMessage, RefusesWordsThatAreCutShort) {
  RankMessage sent;
  sent.add(0, PacketId(1), Packet());
  sent.farewell = Farewell{Farewell::Reason::kFault, "a reason of some length"};
  std::vector<std::uint64_t> words;
  sent.write(words);
  for (std::size_t size = 0; size < words.size(); ++size)
    EXPECT_THROW(RankMessage().read(std::span(words).first(size)), SimulationError) << size;
  words.push_back(0);
  EXPECT_THROW(RankMessage().read(words), SimulationError);
}

TEST(RankShare, GivesEachResourceAndSlotToOneRank) {
  for (std::uint32_t resources = 1; resources < 20; ++resources) {
    for (std::uint32_t ranks = 1; ranks <= resources; ++ranks) {
      for (std::uint32_t rank = 0; rank < ranks; ++rank) {
        const RankShare share(rank, ranks, resources);
        EXPECT_GE(share.arc_size(), 1u);
        for (std::uint32_t r = 0; r < resources; ++r) {
          EXPECT_EQ(share.here(ResourceId(r)), r >= share.arc_begin() && r < share.arc_end());
          // As many slots as resources, for the same test.
          EXPECT_EQ(share.lessee(r, resources) == rank,
                    r >= share.lease_begin(resources) && r < share.lease_end(resources));
        }
      }
      EXPECT_EQ(RankShare(ranks - 1, ranks, resources).arc_end(), resources);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus

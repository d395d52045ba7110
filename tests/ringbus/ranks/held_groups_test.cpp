#include "ringbus/native/ranks/held_groups.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

TEST(HeldGroups, LeaveInTheirOrderWhenEachRankHasTakenEnough) {
  HeldGroups held;
  held.add(ResourceId(4), {}, {{0, 10}, {2, 5}});
  held.add(ResourceId(7), {}, {});
  std::array<std::uint64_t, 3> taken{9, 0, 5};
  bool place = true;
  std::vector<std::uint32_t> issued;
  const auto deliver = [&] {
    return held.deliver([&](std::uint32_t rank) { return taken[rank]; },
                        [&](ResourceId issuer, RayGroup&) {
                          if (place) issued.push_back(issuer.value);
                          return place;
                        });
  };
  EXPECT_FALSE(deliver());  // rank 0 lacks a ray, and the second group stays behind the first
  taken[0] = 10;
  place = false;
  EXPECT_FALSE(deliver());
  EXPECT_EQ(held.size(), 2u);
  place = true;
  EXPECT_TRUE(deliver());
  EXPECT_EQ(issued, (std::vector<std::uint32_t>{4, 7}));
  EXPECT_FALSE(deliver());
}

}  // namespace
}  // namespace carousel::ringbus

// The choice of treelets to prefetch, to the cycle.
#include "ringbus/cycle/tile/warps/treelet_prefetcher.h"

#include <gtest/gtest.h>

namespace carousel::ringbus::cycle {
namespace {

/// Three treelets of one node each.
struct Prefetcher {
  explicit Prefetcher(std::int64_t rays) : of(config(rays), &pieces, 8) {}
  static SimtConfig config(std::int64_t rays) {
    SimtConfig c;
    c.prefetch = SimtConfig::Prefetch::kTreelet;
    c.prefetch_rays = rays;
    c.vote_cycles = 10;
    return c;
  }
  static accel::TreePieces three() {
    accel::TreePieces out;
    for (std::uint32_t node = 0; node < 3; ++node) {
      out.pieces.push_back({accel::NodeRef::inner(node), node * 256, 256, 1, 0, 0});
      out.of_node.push_back(node);
    }
    return out;
  }
  void vote(std::uint32_t slot, std::uint32_t node, Cycle now) { of.vote(slot, accel::NodeRef::inner(node), now); }

  accel::TreePieces pieces = three();
  TreeletPrefetcher of;
};

TEST(TreeletPrefetcher, WaitsForEnoughRaysAndForItsVote) {
  Prefetcher p(2);
  p.vote(0, 1, 100);
  EXPECT_EQ(p.of.next(), kNever);
  p.vote(0, 1, 101);  // it is there already
  EXPECT_EQ(p.of.next(), kNever);
  p.vote(1, 1, 102);
  EXPECT_EQ(p.of.next(), 112u);
  EXPECT_EQ(p.of.choose(111), nullptr);
  ASSERT_NE(p.of.choose(112), nullptr);
  EXPECT_EQ(p.of.counts().votes, 2u);
  EXPECT_EQ(p.of.counts().prefetches, 1u);
}

TEST(TreeletPrefetcher, TakesNoTreeletThatRaysLeftMeanwhile) {
  Prefetcher p(2);
  p.vote(0, 1, 100);
  p.vote(1, 1, 100);
  p.vote(1, 2, 105);  // one ray is left, and another treelet has one
  EXPECT_EQ(p.of.choose(110), nullptr);
  p.vote(0, 2, 120);
  EXPECT_EQ(p.of.next(), 130u);
  EXPECT_EQ(p.of.choose(130), &p.pieces.pieces[2]);
  EXPECT_EQ(p.of.counts().votes, 4u);
}

TEST(TreeletPrefetcher, TakesTheTreeletOfTheMostRaysOnce) {
  Prefetcher p(1);
  for (const std::uint32_t slot : {0, 1}) p.vote(slot, 0, 0);
  for (const std::uint32_t slot : {2, 3, 4}) p.vote(slot, 2, 0);
  EXPECT_EQ(p.of.choose(10), &p.pieces.pieces[2]);
  p.vote(5, 1, 11);
  EXPECT_EQ(p.of.next(), kNever);  // while it is read nothing is chosen
  p.of.read(20);
  EXPECT_EQ(p.of.next(), 30u);
  EXPECT_EQ(p.of.choose(30), &p.pieces.pieces[0]);
  p.of.read(40);
  EXPECT_EQ(p.of.choose(50), &p.pieces.pieces[1]);
  p.of.read(60);
  EXPECT_EQ(p.of.choose(70), nullptr);  // each has been
  EXPECT_EQ(p.of.next(), kNever);
}

TEST(TreeletPrefetcher, TakesATreeletAgainWhenAllHaveLeftIt) {
  Prefetcher p(1);
  p.vote(0, 0, 0);
  EXPECT_EQ(p.of.choose(10), &p.pieces.pieces[0]);
  p.of.read(11);
  EXPECT_EQ(p.of.choose(21), nullptr);
  p.vote(1, 0, 30);
  EXPECT_EQ(p.of.next(), kNever);
  p.of.leave(0, 31);
  p.of.leave(1, 31);
  p.vote(2, 0, 32);
  EXPECT_EQ(p.of.next(), 42u);
  p.of.leave(2, 33);
  EXPECT_EQ(p.of.next(), kNever);  // nobody is left
}

}  // namespace
}  // namespace carousel::ringbus::cycle

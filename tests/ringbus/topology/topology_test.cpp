#include "ringbus/topology/topology.h"

#include <set>

#include <gtest/gtest.h>

namespace carousel::ringbus {
namespace {

TopologyConfig config(TopologyShape shape, std::int64_t resources, Visit visit = Visit::kAll) {
  TopologyConfig c;
  c.shape = shape;
  c.resources = resources;
  c.visit = visit;
  return c;
}

Packet packet(std::uint32_t owner, std::initializer_list<std::uint32_t> owners, std::uint16_t direction = 0,
              std::uint32_t resources = 70) {
  Packet p;
  p.owner = p.home = ResourceId(owner);
  p.direction = direction;
  p.owners.resize((resources + 63) / 64);
  for (const std::uint32_t r : owners) p.owners[r / 64] |= std::uint64_t{1} << (r % 64);
  return p;
}

/// Follows the packet from its owner until it is back; who handles it on the way, in order.
std::vector<std::uint32_t> route(const Topology& topology, const Packet& p,
                                 std::vector<std::uint32_t>* through = nullptr) {
  std::vector<std::uint32_t> handled;
  ResourceId at = p.owner;
  for (std::size_t steps = 0; steps <= topology.resources(); ++steps) {
    at = topology.next(p, at);
    if (at == p.owner) return handled;
    if (through != nullptr) through->push_back(at.value);
    if (topology.handles(p, at)) handled.push_back(at.value);
  }
  ADD_FAILURE() << "never came home";
  return handled;
}

using Route = std::vector<std::uint32_t>;

TEST(Topology, WiresAreTheShape) {
  EXPECT_TRUE(Topology(config(TopologyShape::kRing, 1)).wires().empty());
  EXPECT_TRUE(Topology(config(TopologyShape::kPointToPoint, 1)).wires().empty());
  for (const std::uint32_t n : {2u, 3u, 16u}) {
    const Topology ring(config(TopologyShape::kRing, n)), both(config(TopologyShape::kBidirectional, n)),
        all(config(TopologyShape::kPointToPoint, n));
    EXPECT_EQ(ring.wires().size(), n);
    for (const Topology::Wire& w : ring.wires()) EXPECT_EQ(w.to.value, (w.from.value + 1) % n);
    EXPECT_EQ(both.wires().size(), 2 * n);
    EXPECT_EQ(both.directions(), 2u);
    for (const Topology::Wire& w : both.wires())
      EXPECT_EQ(w.to.value, (w.from.value + (w.direction == 0 ? 1 : n - 1)) % n);
    std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Topology::Wire& w : all.wires()) {
      EXPECT_NE(w.from, w.to);
      pairs.insert({w.from.value, w.to.value});
    }
    EXPECT_EQ(pairs.size(), n * (n - 1));
    EXPECT_TRUE(all.direct());
  }
}

TEST(Topology, VisitAllIsHandledByEveryone) {
  for (const TopologyShape shape :
       {TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kPointToPoint}) {
    const Topology t(config(shape, 5));
    EXPECT_EQ(route(t, packet(2, {2, 4})), (Route{3, 4, 0, 1}));
    EXPECT_EQ(t.hops(packet(2, {2})), 5u);
  }
  const Topology both(config(TopologyShape::kBidirectional, 5));
  EXPECT_EQ(route(both, packet(2, {4}, 1)), (Route{1, 0, 4, 3}));
}

TEST(Topology, VisitOwnersIsHandledByThemAlone) {
  for (const TopologyShape shape : {TopologyShape::kRing, TopologyShape::kPointToPoint}) {
    const Topology t(config(shape, 70, Visit::kOwners));
    EXPECT_EQ(route(t, packet(68, {0, 65, 68})), (Route{0, 65}));
  }
  std::vector<std::uint32_t> through;
  route(Topology(config(TopologyShape::kRing, 70, Visit::kOwners)), packet(68, {0, 65}), &through);
  EXPECT_EQ(through.size(), 69u);  // a ring has no short cuts
  through.clear();
  route(Topology(config(TopologyShape::kPointToPoint, 70, Visit::kOwners)), packet(68, {0, 65}), &through);
  EXPECT_EQ(through, (Route{0, 65}));
}

TEST(Topology, PacketOfLocalRaysNeedNotTravel) {
  const Topology owners(config(TopologyShape::kRing, 5, Visit::kOwners)), all(config(TopologyShape::kRing, 5));
  EXPECT_EQ(owners.hops(packet(2, {2})), 0u);
  EXPECT_EQ(owners.hops(packet(2, {2, 3})), 5u);
  EXPECT_EQ(all.hops(packet(2, {2})), 5u);
  EXPECT_EQ(Topology(config(TopologyShape::kRing, 1)).hops(packet(0, {0})), 0u);
}

TEST(Topology, MembershipsGoToTheirHomeAlone) {
  for (const Visit visit : {Visit::kAll, Visit::kOwners}) {
    const Topology t(config(TopologyShape::kRing, 5, visit));
    Packet p = packet(1, {2, 3});
    p.kind = PacketKind::kMemberships;
    p.home = ResourceId(4);
    EXPECT_EQ(route(t, p), (Route{4}));
    EXPECT_EQ(t.hops(p), 5u);
  }
}

TEST(Topology, NewRaysAreOfferedToEveryone) {
  for (const Visit visit : {Visit::kAll, Visit::kOwners}) {
    const Topology t(config(TopologyShape::kPointToPoint, 4, visit));
    Packet p = packet(1, {});
    p.kind = PacketKind::kRays;
    EXPECT_EQ(route(t, p), (Route{2, 3, 0}));
  }
}

TEST(Topology, CreditsStayBelowWhatTheRingHolds) {
  for (const std::int64_t depth : {1, 2, 16}) {
    for (const std::int64_t resources : {2, 5, 16}) {
      TopologyConfig c = config(TopologyShape::kRing, resources);
      c.link.depth = depth;
      c.flow = Flow::kCredits;
      const auto n = static_cast<std::uint32_t>(resources), d = static_cast<std::uint32_t>(depth);
      EXPECT_GE(Topology(c).packets_in_flight(), 1u);
      EXPECT_LT(n * Topology(c).packets_in_flight(), n * d + n);  // links and one egress place a resource
      c.flow = Flow::kNone;
      EXPECT_GT(n * Topology(c).packets_in_flight(), n * d + n);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus

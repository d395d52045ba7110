#include "ringbus/topology/topology.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "core/config/config.h"
#include "core/config/load/validate.h"
#include "core/types/enum_names.h"

namespace carousel::ringbus {
namespace {

TopologyConfig config(TopologyShape shape, std::int64_t resources, Visit visit = Visit::kAll) {
  TopologyConfig c;
  c.shape = shape;
  c.resources = resources;
  c.visit = visit;
  if (shape != TopologyShape::kGraph) return c;
  c.nodes.emplace_back().name = "r";
  c.nodes.back().count = resources;
  if (resources == 1) return c;
  GraphLink& all = c.links.emplace_back();
  all.from = all.all_to = "r[*]";
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

/// True if the packet has work at `here`; otherwise it passes.
bool handles(const Topology& topology, const Packet& p, ResourceId here) {
  if (topology.visits_all()) return p.kind != PacketKind::kMemberships || here == p.home;
  return topology.wanted(p, here);
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
    if (handles(topology, p, at)) handled.push_back(at.value);
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

/// Every shape with several resources.
std::vector<TopologyShape> all_shapes() {
  std::vector<TopologyShape> shapes;
  for (const auto& one : kEnumNames<TopologyShape>)
    if (one.value != TopologyShape::kCentral) shapes.push_back(one.value);
  return shapes;
}

TEST(Topology, EveryWireIsAPortAtBothOfItsEnds) {
  for (const TopologyShape shape : all_shapes()) {
    for (const std::uint32_t n : {1u, 2u, 5u, 16u}) {
      SCOPED_TRACE(std::string(enum_name(shape)) + " " + std::to_string(n));
      const Topology t(config(shape, n));
      std::multiset<std::uint32_t> in, out, wires;
      for (std::uint32_t node = 0; node < n + t.hubs().size(); ++node) {
        for (const std::uint32_t wire : t.ports(ResourceId(node)).in) {
          EXPECT_EQ(t.wires()[wire].to.value, node);
          in.insert(wire);
        }
        for (const std::uint32_t wire : t.ports(ResourceId(node)).out) {
          EXPECT_EQ(t.wires()[wire].from.value, node);
          out.insert(wire);
        }
      }
      for (std::uint32_t wire = 0; wire < t.wires().size(); ++wire) wires.insert(wire);
      EXPECT_EQ(in, wires);
      EXPECT_EQ(out, wires);
    }
  }
}

TEST(Topology, PacketsLeaveByTheWireToTheirNextStop) {
  for (const TopologyShape shape : all_shapes()) {
    for (const Visit visit : {Visit::kAll, Visit::kOwners}) {
      const Topology t(config(shape, 5, visit));
      if (t.wires().empty()) continue;
      for (std::uint16_t d = 0; d < t.directions(); ++d) {
        const Packet p = packet(1, {0, 3}, d);
        for (std::uint32_t here = 0; here < 5; ++here) {
          const std::uint32_t wire = t.ports(ResourceId(here)).out[t.out_port(p, ResourceId(here))];
          const bool by_bus = !t.hubs().empty() && t.hubs()[0] == Topology::Hub::kBus;
          const ResourceId next = t.next(p, ResourceId(here));
          ResourceId at = t.wires()[wire].to;
          for (std::size_t hops = 0; t.routed() && at != next && hops < 12; ++hops)
            at = t.wires()[t.ports(at).out[t.exit(at, next, d).port]].to;
          EXPECT_EQ(at, by_bus ? ResourceId(5) : next) << enum_name(shape) << " at " << here;
        }
      }
    }
  }
}

TEST(Topology, SkipCountsTheResourcesUntilTheNextThatIsWanted) {
  for (const TopologyShape shape : {TopologyShape::kRing, TopologyShape::kBidirectional, TopologyShape::kMultiRing}) {
    const Topology t(config(shape, 70, Visit::kOwners));
    for (std::uint16_t d = 0; d < t.directions(); ++d) {
      const Packet p = packet(68, {0, 1, 65}, d);
      for (std::uint32_t here = 0; here < 70; ++here) {
        std::uint16_t expected = 0;
        for (ResourceId at = t.next(p, ResourceId(here)); at != p.owner && !t.wanted(p, at); at = t.next(p, at))
          ++expected;
        EXPECT_EQ(t.skip(p, ResourceId(here)), expected);
      }
    }
  }
}

TEST(Topology, GroupsAreLinesBetweenBridges) {
  TopologyConfig c = config(TopologyShape::kHierarchical, 7, Visit::kOwners);
  c.groups = 3;
  const Topology t(c);
  // Bridges 7, 8, 9 before resources 0 to 2, 3 to 4 and 5 to 6.
  ASSERT_EQ(t.hubs().size(), 3u);
  const auto way = [&](std::uint32_t from, std::uint32_t to) {
    Route out;
    for (ResourceId at(from); at.value != to; out.push_back(at.value))
      at = t.wires()[t.ports(at).out[t.exit(at, ResourceId(to)).port]].to;
    return out;
  };
  EXPECT_EQ(way(1, 4), (Route{2, 7, 8, 3, 4}));
  EXPECT_EQ(way(4, 6), (Route{8, 9, 5, 6}));
  EXPECT_EQ(way(6, 1), (Route{9, 7, 0, 1}));
  EXPECT_EQ(t.wires().size(), 7u + 3u + 3u);
}

TEST(Topology, LanesAreDirectionsWithWaysOfTheirOwn) {
  TopologyConfig c = config(TopologyShape::kGraph, 4, Visit::kOwners);
  c.tour = Tour::kNearest;
  c.links.resize(2);
  c.links[0].from = c.links[0].all_to = "";
  c.links[0].ring = "r[*]";
  c.links[1].ring = "r[3..0]";
  c.links[0].lane = 0;
  c.links[1].lane = 1;
  const Topology t(c);
  ASSERT_EQ(t.directions(), 2u);
  const auto next = [&](std::uint32_t here, std::uint16_t lane) {
    return t.next(packet(here, {0, 1, 2, 3}, lane), ResourceId(here)).value;
  };
  const auto along = [&](std::uint32_t here, std::uint32_t to, std::uint16_t lane) {
    const ResourceId at(here);
    return t.wires()[t.ports(at).out[t.exit(at, ResourceId(to), lane).port]].to.value;
  };
  for (std::uint32_t here = 0; here < 4; ++here) {
    EXPECT_EQ(next(here, 0), (here + 1) % 4);
    EXPECT_EQ(next(here, 1), (here + 3) % 4);
    EXPECT_EQ(along(here, (here + 2) % 4, 0), (here + 1) % 4);
    EXPECT_EQ(along(here, (here + 2) % 4, 1), (here + 3) % 4);
  }
}

TEST(Topology, ADrawnBusHasItsPortsByResource) {
  TopologyConfig c = config(TopologyShape::kGraph, 3);
  GraphNode& bus = c.nodes.emplace_back();
  bus.name = "b";
  bus.kind = GraphNodeKind::kBus;
  c.links.resize(1);
  c.links[0].all_to = "";
  c.links[0].from = "r[2], r[0], r[1]";
  c.links[0].to = "b";
  c.links[0].both = true;
  const Topology t(c);
  ASSERT_TRUE(t.broadcasts());
  for (std::uint32_t r = 0; r < 3; ++r) {
    EXPECT_EQ(t.wires()[t.ports(ResourceId(3)).in[r]].from.value, r);
    EXPECT_EQ(t.wires()[t.ports(ResourceId(3)).out[r]].to.value, r);
  }
}

TEST(Topology, ABusTakesTheLatencyOfOneLink) {
  for (const std::int64_t latency : {2, 3, 8}) {
    TopologyConfig c = config(TopologyShape::kBus, 3);
    c.link.latency_cycles = latency;
    const Topology t(c);
    for (const Topology::Wire& there : t.wires())
      for (const Topology::Wire& back : t.wires())
        if (there.to.value == 3 && back.from.value == 3) {
          EXPECT_EQ(there.latency_cycles + back.latency_cycles, latency);
        }
  }
}

/// The shortest way by arithmetic, shape by shape.
Topology::Route shortest(const TopologyConfig& c, std::uint32_t from, std::uint32_t to, std::uint32_t random) {
  const auto n = static_cast<std::uint32_t>(c.resources);
  const std::uint32_t ahead = (to + n - from) % n, back = n - ahead;
  const auto hops = static_cast<std::uint16_t>(ahead);
  if (c.shape == TopologyShape::kPointToPoint || c.shape == TopologyShape::kGraph)
    return {0, static_cast<std::uint16_t>(ahead != 0)};
  if (c.shape == TopologyShape::kMultiRing) return {static_cast<std::uint16_t>(random % c.rings), hops};
  if (c.shape == TopologyShape::kBidirectional && (ahead > back || (ahead == back && random % 2 == 1)))
    return {1, static_cast<std::uint16_t>(back)};
  return {0, hops};
}

TEST(Topology, TrafficTakesTheShortestWay) {
  for (const TopologyShape shape : all_shapes()) {
    for (const std::int64_t n : {1, 2, 5, 8}) {
      TopologyConfig c = config(shape, n);
      c.rings = 3;
      const Topology t(c);
      if (!t.carries_traffic() || shape == TopologyShape::kHierarchical) continue;  // that one runs as a graph
      for (std::uint32_t from = 0; from < n; ++from) {
        for (std::uint32_t to = 0; to < n; ++to) {
          for (std::uint32_t random = 0; random < 7; ++random) {
            const Topology::Route way = t.route(ResourceId(from), ResourceId(to), random);
            const Topology::Route expected = shortest(c, from, to, random);
            EXPECT_EQ(way.hops, expected.hops) << enum_name(shape) << " " << from << " to " << to;
            if (way.hops > 0) {
              EXPECT_EQ(way.direction, expected.direction);
            }
          }
        }
      }
    }
  }
}

TEST(Topology, TheValidatorAllowsTrafficWhereTheShapeCarriesIt) {
  for (const TopologyShape shape : all_shapes()) {
    Config c;
    c.engine.kind = EngineKind::kCycle;
    c.workload.kind = WorkloadConfig::Kind::kTraffic;
    c.topology.shape = shape;
    const std::vector<ConfigIssue> issues = validate_config(c, KeyPositions{});
    const bool refused = std::any_of(issues.begin(), issues.end(),
                                     [](const ConfigIssue& issue) { return issue.key_path == "topology.shape"; });
    EXPECT_NE(refused, Topology(c.topology).carries_traffic()) << enum_name(shape);
  }
}

}  // namespace
}  // namespace carousel::ringbus

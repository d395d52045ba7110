// The source, the sink and the credits of a node in a network without rays, each by itself.
#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/traffic/delivery_credits.h"
#include "ringbus/cycle/traffic/source_queues.h"
#include "ringbus/cycle/traffic/traffic_sink.h"
#include "tests/ringbus/time/loose_channel.h"
#include "tests/ringbus/traffic/traffic_config.h"

namespace carousel::ringbus::cycle {
namespace {

TEST(TrafficSink, TakesAFlitACycleAndCountsThoseOfTheWindow) {
  TrafficNodeSettings settings;
  settings.eject_cycles = 3;
  settings.flits = 2;
  TrafficSink sink(settings, {100, 200});
  TrafficToken token;
  token.hops = 4;
  token.created = 90;
  sink.deliver(token, 95);  // it is delivered before the window begins
  EXPECT_EQ(sink.opens(), 97u);
  EXPECT_FALSE(sink.open(96));
  token.created = 105;
  sink.deliver(token, 120);
  token.created = 150;
  sink.deliver(token, 197);  // it is delivered when the window has ended
  EXPECT_EQ(sink.delivered(), 3u);
  EXPECT_EQ(sink.accepted(), 1u);
  EXPECT_EQ(sink.accepted_hops(), 4u);
  EXPECT_EQ(sink.latency().count(), 2u);
  EXPECT_EQ(sink.latency().max(), 50u);
  EXPECT_EQ(sink.last(), 200u);
}

/// Resource 1 of a ring, with the wires of acknowledgements beside it.
struct CreditsOfARing {
  Config config = [] {
    Config with_depth = traffic_config(TopologyShape::kRing, 4, TrafficConfig::Pattern::kUniform, 0.5, 10);
    with_depth.topology.flow = Flow::kCredits;
    return with_depth;
  }();
  Topology topology{config.topology};
  LooseChannel<TrafficAck> in, out;
  TrafficNodeSettings settings{.link_latency = 4, .link_depth = 2};
  DeliveryCredits credits{ResourceId(1), topology, settings, {&in}, {&out}};
};

TEST(DeliveryCredits, AreUsedUpAndComeBackWithAcknowledgements) {
  CreditsOfARing ring;
  DeliveryCredits& credits = ring.credits;
  EXPECT_EQ(credits.opens(0, 10), 10u);
  EXPECT_TRUE(credits.use(0, 10));
  EXPECT_TRUE(credits.use(0, 10));
  EXPECT_FALSE(credits.use(0, 10));
  EXPECT_EQ(credits.opens(0, 10), kNever);
  ring.in.send(15, {1, 0});
  EXPECT_EQ(credits.next(), 15u);
  credits.take(16);
  EXPECT_EQ(credits.opens(0, 12), 15u);
  EXPECT_FALSE(credits.use(0, 14));
  EXPECT_TRUE(credits.use(0, 15));
}

TEST(DeliveryCredits, AcknowledgementsOfOthersGoOnBeforeLaterOnesOfItsOwn) {
  CreditsOfARing ring;
  ring.in.send(15, {3, 0});
  ring.in.send(18, {2, 0});
  ring.credits.take(20);
  TrafficToken token;
  token.source = 0;
  ring.credits.acknowledge(token, 0, 16);
  ring.credits.forward(20);
  for (const auto& [at, source] : {std::pair(19u, 3u), std::pair(20u, 0u), std::pair(22u, 2u)}) {
    EXPECT_EQ(ring.out.next(), at);
    EXPECT_EQ(ring.out.take().source, source);
  }
  EXPECT_EQ(ring.out.next(), kNever);
}

TEST(SourceQueues, SeveralReadTheSamePacketsAsOne) {
  const Config config = traffic_config(TopologyShape::kBidirectional, 8, TrafficConfig::Pattern::kUniform, 0.5, 800);
  const Topology topology(config.topology);
  const GeometricGap gap = traffic_gap(config.workload.traffic);
  const TrafficEnds ends = traffic_ends(config.topology, config.workload.traffic);
  const TrafficSource source(config.workload.traffic, 1, 8, ends, ResourceId(3), gap);
  std::vector<Cycle> created[2];
  for (const bool shared : {true, false}) {
    TrafficNodeSettings settings = traffic_node_settings(config.workload.traffic, config.topology.link);
    settings.shared_queue = shared;
    SourceQueues queues(ResourceId(3), topology, settings, source, 100, {0, 1000}, 2);
    EXPECT_EQ(queues.all().size(), shared ? 1u : 3u);
    while (queues.due() != kNever) {
      const Cycle now = queues.due();
      queues.for_each_due(now, [&](SourceQueues::Queue& queue) {
        EXPECT_GE(now, queue.source.created() + settings.inject_cycles);
        created[shared].push_back(queue.source.created());
        queues.injected(queue, now);
      });
    }
    EXPECT_EQ(queues.left(), 0u);
    EXPECT_EQ(queues.offered(), 100u);
    std::sort(created[shared].begin(), created[shared].end());
  }
  EXPECT_EQ(created[0].size(), 100u);
  EXPECT_EQ(created[0], created[1]);
}

}  // namespace
}  // namespace carousel::ringbus::cycle

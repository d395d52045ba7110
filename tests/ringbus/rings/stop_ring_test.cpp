// Rings whose stops have no queues: closed forms, conservation, who goes first, and how long a stop waits.
#include <array>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "ringbus/topology/graph_facts.h"
#include "tests/ringbus/rings/ring_run.h"
#include "tests/ringbus/traffic/created_packets.h"

namespace carousel::ringbus::stop_ring_test {
namespace {

/// A ring of six stops. `ring`: keys of its link, `traffic` of the workload.
std::string six(const std::string& ring, const std::string& traffic, const std::string& more = "") {
  return "engine: {kind: cycle}\n" + more +
         "topology:\n  shape: graph\n  nodes: [{name: s, count: 6}]\n  links: [{ring: 's[*]', " + ring +
         "}]\nworkload: {traffic: {" + traffic + "}}\n";
}

struct Clocks {
  std::int64_t core, noc, synchroniser;
};

/// When a packet is delivered, in steps of which both clocks have a whole number to a cycle.
std::uint64_t delivered(const Clocks& clocks, std::uint64_t created, std::uint64_t inject, std::uint64_t way,
                        std::uint64_t eject) {
  const auto core_step = static_cast<std::uint64_t>(clocks.noc), noc_step = static_cast<std::uint64_t>(clocks.core);
  const std::uint64_t cost = clocks.core == clocks.noc ? 0 : static_cast<std::uint64_t>(clocks.synchroniser);
  std::uint64_t at = (created + inject) * core_step;
  while (at % noc_step != 0) ++at;  // the next edge of the network
  at += (cost + way) * noc_step;
  while (at % core_step != 0) ++at;
  return at / core_step + cost + eject;
}

struct Form {
  std::string link;
  std::uint64_t bytes, hop;
  std::uint64_t flits_cycles;  // all but the hops
};

TEST(StopRing, APacketAloneTakesTheClosedForm) {
  const std::vector<Form> forms{
      {"latency_cycles: 1, stops: {rule: slots}", 32, 1, 0},
      {"latency_cycles: 3, stops: {rule: slots, rings: 2}", 100, 3, 3},                             // 4 flits
      {"latency_cycles: 2, stops: {rule: slots, port_bytes_per_cycle: 16}", 64, 2, 2 * 2 - 1 + 1},  // 2 flits of 2
      {"latency_cycles: 1, stops: {rule: grants}", 128, 1, 1 + 3},                                  // 4 beats
      {"latency_cycles: 5, bytes_per_cycle: 16, stops: {rule: grants, grant_cycles: 4, rings: 3}", 128, 5, 4 + 7},
      {"latency_cycles: 2, stops: {rule: grants, port_bytes_per_cycle: 8}", 128, 2, 1 + 15},
  };
  for (const Clocks& clocks :
       {Clocks{1000, 1000, 2}, Clocks{1500, 2000, 2}, Clocks{3200, 1600, 0}, Clocks{700, 300, 5}})
    for (const bool both : {false, true})
      for (const Form& form : forms)
        for (const std::uint32_t to : {1u, 3u, 4u}) {
          SCOPED_TRACE(fmt::format("{} both: {} to {} at {}:{}", form.link, both, to, clocks.core, clocks.noc));
          const Config config = ring_config(
              six(fmt::format("both: {}, {}", both, form.link),
                  fmt::format("sources: 's[0]', destinations: 's[{}]', rate: 0.00002, packets: 20, packet_bytes: {}, "
                              "inject_cycles: 3, eject_cycles: 2, warmup_fraction: 0",
                              to, form.bytes),
                  fmt::format("clocks: {{core: {}, noc: {}, synchroniser_cycles: {}}}\n", clocks.core, clocks.noc,
                              clocks.synchroniser)));
          const TrafficResult result = run_ring(config);
          const std::uint64_t hops = both ? std::min(to, 6 - to) : to;
          std::uint64_t sum = 0;
          for (const std::uint64_t created : created_by(config, 0).times)
            sum += delivered(clocks, created, 3, form.flits_cycles + hops * form.hop, 2) - created;
          EXPECT_EQ(result.latency.count(), 20u);
          EXPECT_EQ(result.latency.sum(), sum);
          EXPECT_NEAR(result.zero_load_latency(config.workload.traffic), result.latency.mean(), 1e-9);
          EXPECT_EQ(result.stops->longest_wait, 0u);
          EXPECT_EQ(result.stops->extra_rounds, 0u);
        }
}

// The answer goes back by the shorter way, and counts as part of the latency.
TEST(StopRing, AnAnswerComesBack) {
  const Config config =
      ring_config(six("latency_cycles: 2, stops: {rule: slots}",
                      "sources: 's[0]', destinations: 's[2]', rate: 0.00002, packets: 20, reply_bytes: "
                      "96, serve_cycles: 30"));
  const TrafficResult result = run_ring(config);
  // One cycle in and one out, 2 hops there, 4 round to the start, and two more flits of the answer.
  EXPECT_EQ(result.latency.quantile(0), 1u + 2 * 2 + 30 + 4 * 2 + 2 + 1);
  EXPECT_EQ(result.latency.max(), result.latency.quantile(0));
  EXPECT_EQ(result.stops->starts, 40u);
}

// Each flit crosses the links of its way, and all of the ring once more for each round that it goes besides.
TEST(StopRing, NothingIsLost) {
  const std::vector<std::string> rules{"rule: slots",
                                       "rule: slots, rings: 3",
                                       "rule: slots, rings: 2, port_bytes_per_cycle: 8, fair_after_cycles: 20",
                                       "rule: grants",
                                       "rule: grants, rings: 2, transfers: 2, command_cycles: 2",
                                       "rule: grants, start_cycles: 7, fair_after_cycles: 50"};
  for (const bool both : {false, true})
    for (const std::string& rule : rules)
      for (const char* pattern : {"uniform", "tornado", "hotspot", "bursty", "exchange"}) {
        SCOPED_TRACE(fmt::format("{} {} {}", rule, pattern, both));
        const Config config = ring_config(
            six(fmt::format("both: {}, latency_cycles: 2, stops: {{{}}}", both, rule),
                fmt::format("pattern: {}, rate: 0.4, packets: 3000, packet_bytes: 96, warmup_fraction: 0", pattern)));
        const TrafficResult result = run_ring(config);
        EXPECT_EQ(result.delivered, 3000u);
        EXPECT_EQ(result.latency.count(), 3000u);
        std::uint64_t crossed = 0, sent = 0;
        for (std::uint32_t from = 0; from < 6; ++from)
          for (const std::uint32_t to : created_by(config, from).to) {
            const std::uint32_t ahead = (to + 6 - from) % 6;
            crossed += 3 * (both ? std::min(ahead, 6 - ahead) : ahead);
            sent += to != from;
          }
        EXPECT_EQ(result.stops->starts, sent);
        EXPECT_EQ(result.flit_hops, crossed + 6 * result.stops->extra_rounds);
      }
}

/// One flit in each cycle from s[0] and from s[1] to s[3], in one direction.
Config one_behind_another(const std::string& stops) {
  return ring_config(six("latency_cycles: 1, stops: {" + stops + "}",
                         "sources: 's[0..1]', destinations: 's[3]', rate: 1, packets: 8000, packet_bytes: 32, "
                         "warmup_fraction: 0"));
}

// s[0] fills every slot, and what is on the ring goes first: its packets go by as if they were alone, and s[1] waits
// until s[0] has no more.
TEST(StopRing, WhatIsOnTheRingGoesFirst) {
  const TrafficResult result = run_ring(one_behind_another("rule: slots"));
  EXPECT_EQ(result.delivered, 8000u);
  for (const double part : {0.01, 0.25, 0.49}) EXPECT_EQ(result.latency.quantile(part), 1u + 3 + 1) << part;
  EXPECT_GE(result.stops->longest_wait, 3990u);
  EXPECT_EQ(result.stops->reservations, 0u);
}

// A stop that has waited marks the slot that passes. It comes back when it has gone round, and then it is empty.
TEST(StopRing, AFairStopWaitsNoLongerThanAMarkedSlotTakes) {
  const TrafficResult result = run_ring(one_behind_another("rule: slots, fair_after_cycles: 16"));
  EXPECT_EQ(result.delivered, 8000u);
  EXPECT_GT(result.stops->reservations, 100u);
  EXPECT_LE(result.stops->longest_wait, 16u + 6);
}

// s[0] asks for three segments of which s[1] and s[2] use one each, in turns, so that one of them is always taken.
TEST(StopRing, AFairArbiterBoundsTheWait) {
  const auto waits = [](const std::string& more) {
    const Config config = ring_config(six("both: false, latency_cycles: 4, stops: {rule: grants" + more + "}",
                                          "rate: 0.3, packets: 6000, packet_bytes: 128"));
    return run_ring(config).stops->longest_wait;
  };
  // The longest of the others is granted first, each when all before it have passed: five hops and four beats.
  constexpr std::uint64_t kOthers = 6 * (5 * 4 + 4);
  EXPECT_LE(waits(", fair_after_cycles: 10"), 10 + kOthers);
  EXPECT_GT(waits(""), 10 + kOthers);
}

// Six slots come in at a stop in a cycle and one gets off: the oldest, so that none goes round for ever.
TEST(StopRing, OldFlitsGetOffFirst) {
  const Config config = ring_config(six("both: true, latency_cycles: 1, stops: {rule: slots, rings: 3}",
                                        "sources: 's[0], s[1], s[3], s[4], s[5]', destinations: 's[2]', rate: 1, "
                                        "packets: 5000, packet_bytes: 32, warmup_fraction: 0"));
  const TrafficResult result = run_ring(config);
  EXPECT_EQ(result.delivered, 5000u);
  EXPECT_GT(result.stops->extra_rounds, 1000u);
  // One gets off in every cycle.
  EXPECT_NEAR(static_cast<double>(result.cycles), 5000, 100);
  // At most 36 flits are on the ring; each round of six cycles is for one of those that have got on earlier.
  EXPECT_LE(result.stops->longest_ride, 36u * 6);
}

// A port of four cycles a flit may be busy with a younger one when an old one comes; it is kept free for its next
// round.
TEST(StopRing, ANarrowPortIsKeptFreeForOldFlits) {
  const Config config =
      ring_config(six("both: true, latency_cycles: 1, stops: {rule: slots, rings: 3, "
                      "port_bytes_per_cycle: 8}",
                      "sources: 's[0], s[1], s[3], s[4], s[5]', destinations: 's[2]', rate: 1, "
                      "packets: 5000, packet_bytes: 32, warmup_fraction: 0"));
  const TrafficResult result = run_ring(config);
  EXPECT_EQ(result.delivered, 5000u);
  EXPECT_GT(result.stops->extra_rounds, 1000u);
  EXPECT_LE(result.stops->longest_ride, 2u * 36 * 6);  // two rounds for each of 36
}

TEST(StopRing, TheVerdictSaysWhoMayWait) {
  const auto verdict = [](const std::string& stops) {
    return traffic_verdict(ring_config(six("stops: {" + stops + "}", "rate: 0.1")).topology);
  };
  EXPECT_FALSE(verdict("rule: slots").can_deadlock);
  EXPECT_NE(verdict("rule: slots").rule.find("may wait for as long as others"), std::string::npos);
  EXPECT_NE(verdict("rule: grants, fair_after_cycles: 9").rule.find("after 9 cycles"), std::string::npos);
}

// A bidirectional ring of stops, by uniform load: each link of a direction is on the ways of as many pairs.
TEST(StopRing, RingsSideBySideShareTheLoad) {
  const auto bound = [](const std::string& rings) {
    return graph_facts(ring_config(six("stops: {rule: slots" + rings + "}", "rate: 0.1")).topology).bound;
  };
  EXPECT_DOUBLE_EQ(bound(", rings: 4"), 4 * bound(""));
}

}  // namespace
}  // namespace carousel::ringbus::stop_ring_test

// On a bus all resources hear a packet at once: it crosses the medium once, and each that has rays of it answers.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::bus_broadcast_test {
namespace {

class BusCrossings : public TimedRun {
 protected:
  Json run(std::vector<std::string> sets) {
    return report(
        "scene: {builtin: terrain, triangles: 600}\n"
        "image: {width: 12, height: 10, samples: 1, max_depth: 3}\n"
        "topology: {resources: 5, shape: bus}\n"
        "packets: {rays: 16}\n"
        "collections: {ready: 16}\n"
        "shading: {workers: 8}\n"
        "rays: {slots_per_resource: 32, placement: round_robin}\n",
        std::move(sets));
  }
  /// Packets and busy cycles of the wires from the resources to the bus, or from the bus to the resources.
  struct Crossings {
    std::uint64_t packets = 0, busy = 0;
  };
  static Crossings crossings(const Json& report, bool to_bus) {
    Crossings out;
    for (const Json& link : report["links"]) {
      if ((link["to"] == 5) != to_bus) continue;
      out.packets += link["packets"].get<std::uint64_t>();
      out.busy += link["cycles"]["busy"].get<std::uint64_t>();
    }
    return out;
  }
};

TEST_F(BusCrossings, APacketCrossesTheMediumOnceAndIsAnswered) {
  for (const char* visit : {"owners", "all"}) {
    SCOPED_TRACE(visit);
    const Json bus = run({fmt::format("topology.visit={}", visit)});
    const std::uint64_t issued = bus["packets"]["issued"];
    const Crossings there = crossings(bus, true), back = crossings(bus, false);
    EXPECT_GT(issued, 100u);
    // On the way to the bus: a broadcast, and answers of at most four resources. From the bus: each broadcast goes to
    // those who answer it, or to all four others, and each answer to one.
    EXPECT_LE(there.packets, 5 * issued);
    const std::uint64_t broadcasts_and_answers = there.packets;
    if (std::string(visit) == "owners") {
      // b broadcasts and a answers: b + a crossings there, a + a back.
      const std::uint64_t answers = back.packets / 2, broadcasts = broadcasts_and_answers - answers;
      EXPECT_EQ(back.packets % 2, 0u);
      EXPECT_LE(broadcasts, issued);
      EXPECT_GE(answers, broadcasts);
    }
    EXPECT_EQ(run({fmt::format("topology.visit={}", visit), "engine.threads=2"})["engine"]["cycles"],
              bus["engine"]["cycles"]);
  }
}

// The shapes that packets carry cross the medium with the broadcast alone.
TEST_F(BusCrossings, AnswersCarryNoShapes) {
  const std::vector<std::string> carry{"packets.carry=data", "memory.fetch=packet", "topology.visit=owners",
                                       "topology.link.bytes_per_cycle=1"};
  const Json bus = run(carry);
  const Crossings there = crossings(bus, true), back = crossings(bus, false);
  const std::uint64_t answers = back.packets / 2, broadcasts = there.packets - answers;
  // A strip of boxes has 256 bytes, and a packet of it at most 16 + 16 * 5 + 32 besides; an answer has no strip.
  EXPECT_LE(there.busy, broadcasts * (512 + 128) + answers * 128);
  EXPECT_GE(there.busy, broadcasts * 160);
}

}  // namespace
}  // namespace carousel::bus_broadcast_test

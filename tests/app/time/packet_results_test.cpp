// How results travel back to the owner of a packet (`packets.results`): bytes and cycles of a packet by hand.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::packet_results_test {
namespace {

struct Outcome {
  std::int64_t cycles = 0, bytes = 0;
  Outcome operator-(const Outcome& b) const { return {cycles - b.cycles, bytes - b.bytes}; }
  bool operator==(const Outcome&) const = default;
};
void PrintTo(const Outcome& outcome, std::ostream* out) {
  *out << outcome.cycles << " cycles, " << outcome.bytes << " bytes";
}

/// Two rays, one for the issuer of the packet of the root and one for the other resource. A link moves one byte a cycle
/// and dispatch reads one ID a cycle, so that cycles tell both.
class PacketResultsTest : public TimedRun {
 protected:
  Json two_rays(const std::string& ray, const std::string& results, std::vector<std::string> sets) {
    program_.write("rays.csv", fmt::format("ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,{}\n1,{}\n", ray, ray));
    sets.push_back("packets.results=" + results);
    return report(
        "scene: {builtin: terrain, triangles: 600}\n"
        "workload: {rays_from: rays.csv}\n"
        "topology: {resources: 2, link: {latency_cycles: 50, bytes_per_cycle: 1}}\n"
        "packets: {rays: 2, ids_per_cycle: 1}\n"
        "collections: {policy: fullest}\n"
        "rays: {placement: round_robin}\n"
        "memory: {shared_by: 2}\n"
        "shading: {workers: 4, cycles_per_shade: 900}\n",
        std::move(sets));
  }
  /// Traces rays that miss everything, so that there is one packet. Shading takes so long that the ray tested last ends
  /// the run, and not the packet.
  Outcome missing(const std::string& results, const std::vector<std::string>& sets = {}) {
    const Json run = two_rays("camera,0,0,900,0,0,1,0,inf", results, sets);
    EXPECT_EQ(run["packets"]["issued"], 1u);
    return {run["engine"]["cycles"], static_cast<std::int64_t>(bytes(run, "packets"))};
  }
  Outcome beyond_mask(const std::string& results, const std::vector<std::string>& sets = {}) {
    return missing(results, sets) - missing("mask", sets);
  }
};

// Mask: 16 + 2 x (4 + 1) = 26 bytes there and back. In implied order the other resource gets its ray's ID and the
// owner's result, which a byte of 2 bits tells apart: 18 + 1 + 4 + 1 = 24, of which it reads one ID; back come two
// results: 18 + 1 + 2 = 21.
TEST_F(PacketResultsTest, StandInThePlacesOfIds) {
  EXPECT_EQ(beyond_mask("implied_order"), (Outcome{-2 - 1, 24 + 21 - 52}));
  // Both IDs there, 18 + 1 + 8 = 27, and a result and the ID that the owner is to find back: 24.
  EXPECT_EQ(beyond_mask("implied_order", {"testers.own_rays=after"}), (Outcome{1 - 2 - 1, 27 + 24 - 52}));
}

// The owner has made eight packets of the one: 16 + 2 x 4 + 1 = 25 bytes each, of which the other reads two IDs each.
TEST_F(PacketResultsTest, MakeAPacketOfEachShape) {
  EXPECT_EQ(beyond_mask("per_shape"), (Outcome{200 - 26 + 14, 400 - 52}));
  // There it has 24 bytes, and the other makes eight.
  EXPECT_EQ(beyond_mask("per_shape", {"testers.own_rays=after"}), (Outcome{-2 + 200 - 26 + 14, 24 + 200 - 52}));
  // Four boxes, each packet with the nearest entry of its own; a mask has room for eight.
  const std::vector<std::string> four{"bvh.width=4", "collections.policy=nearest"};
  EXPECT_EQ(beyond_mask("per_shape", four), (Outcome{4 * 29 - 58 + 6, 2 * 4 * 29 - 2 * 58}));
}

// With data, each takes an eighth of the node's 256 bytes along.
TEST_F(PacketResultsTest, OfAShapeBringItsData) {
  EXPECT_EQ(beyond_mask("per_shape", {"packets.carry=data", "memory.fetch=packet"}),
            (Outcome{8 * (25 + 32) - 282 + 14, 2 * (8 * (25 + 32) - 282)}));
}

TEST_F(PacketResultsTest, AreNotInThePacketIfMessagesBringThem) {
  EXPECT_EQ(beyond_mask("message"), (Outcome{-2, -4}));
}

// The other answers its own ray alone: 21 bytes as a mask, as a note of its end 16, in order 18 + 1 + 1, and in eight
// packets of 16 + 4 + 1. The packet itself has 26, 24, 18 + 1 + 4 + 1 and 8 x 25 bytes. With own rays last, which the
// packet then has as 24, 27 and 24 bytes, the answers count, over two wires each.
TEST_F(PacketResultsTest, AnswerOnABus) {
  const std::vector<std::string> bus{"topology.shape=bus"}, last{"topology.shape=bus", "testers.own_rays=after"};
  EXPECT_EQ(beyond_mask("message", bus).bytes, (24 + 16) * 2 - (26 + 21) * 2);
  EXPECT_EQ(beyond_mask("implied_order", bus).bytes, (24 + 20) * 2 - (26 + 21) * 2);
  EXPECT_EQ(beyond_mask("per_shape", bus).bytes, (200 + 168) * 2 - (26 + 21) * 2);
  EXPECT_EQ(beyond_mask("message", last), (Outcome{2 * (24 + 16) - 2 * (26 + 21), (24 + 16) * 2 - (26 + 21) * 2}));
  EXPECT_EQ(beyond_mask("implied_order", last),
            (Outcome{2 * (27 + 20) - 2 * (26 + 21), (27 + 20) * 2 - (26 + 21) * 2}));
  EXPECT_EQ(beyond_mask("per_shape", last),
            (Outcome{2 * (24 + 168) - 2 * (26 + 21) + 7, (24 + 168) * 2 - (26 + 21) * 2}));
}

// Leaves below the root, of which rays along the diagonal meet three. A message a hit of the other's ray, 16 + 4 bytes,
// comes before the packet, which has 2 bytes less. A packet of a leaf has 16 + 2 x 4 bytes in any case.
TEST_F(PacketResultsTest, ComeAsAMessageForEachHit) {
  std::int64_t hits = 0;
  const auto run = [&](const char* results, const char* own_rays) -> Outcome {
    const Json out = two_rays("camera,-900,0,-900,1,0,1,0,inf", results,
                              {"scene.triangles=18", "bvh.width=4", "bvh.leaf_triangles=16", own_rays});
    hits = out["nodes"]["by_depth"][0]["children_hit"].get<std::int64_t>() / 2;
    EXPECT_EQ(out["packets"]["issued"].get<std::int64_t>(), 1 + hits);
    return {out["engine"]["cycles"], static_cast<std::int64_t>(bytes(out, "packets"))};
  };
  const auto beyond_mask = [&](const char* own_rays) { return run("message", own_rays) - run("mask", own_rays); };
  const std::int64_t moved = 2 * (24 - 26) + 20 * 3;
  // They are read while the leaves are fetched.
  EXPECT_EQ(beyond_mask("testers.own_rays=before"), (Outcome{moved, moved}));
  ASSERT_EQ(hits, 3);
  // Here the leaves' packets wait for nothing but dispatch, which reads each message for a cycle.
  EXPECT_EQ(beyond_mask("testers.own_rays=after"), (Outcome{moved + hits, moved}));
}

// A header names what to do. The root's packet leaves both resources, and those of three leaves; a message is a result,
// and so is an answer.
TEST_F(PacketResultsTest, AreToldApartByTheirKind) {
  const auto sent = [&](const char* results, std::vector<std::string> sets) {
    return two_rays("camera,-900,0,-900,1,0,1,0,inf", results, std::move(sets))["packets"]["sent"];
  };
  const auto leaves = [](const char* set) {
    return std::vector<std::string>{"scene.triangles=18", "bvh.width=4", "bvh.leaf_triangles=16", set};
  };
  const char* ring = "topology.shape=ring";
  EXPECT_EQ(sent("mask", leaves(ring)),
            Json::parse(R"({"load": 0, "join": 0, "box": 2, "triangle": 6, "procedural": 0, "result": 0})"));
  EXPECT_EQ(sent("message", leaves(ring)),
            Json::parse(R"({"load": 0, "join": 0, "box": 2, "triangle": 6, "procedural": 0, "result": 3})"));
  EXPECT_EQ(sent("mask", leaves("topology.shape=bus")),
            Json::parse(R"({"load": 0, "join": 0, "box": 1, "triangle": 3, "procedural": 0, "result": 4})"));
  EXPECT_GT(sent("mask", leaves("rays.placement=first_taker"))["load"], 0);
  EXPECT_GT(sent("mask", {"collections.home=hash", "collections.when_full=spill"})["join"], 0);
  const Json spheres = sent("mask", {"scene.builtin=spheres", "scene.procedural=true"});
  EXPECT_GT(spheres["procedural"], 0);
}

TEST_F(PacketResultsTest, OfAShapeAreCountedEach) {
  EXPECT_EQ(two_rays("camera,0,0,900,0,0,1,0,inf", "per_shape", {})["packets"]["sent"]["box"], 16);
}

}  // namespace
}  // namespace carousel::packet_results_test

// The issuer of a packet tests its own rays before the packet leaves, or after it has come back (`testers.own_rays`).
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::own_rays_test {
namespace {

/// Two rays that miss everything, so that there is one packet: it carries both to the root's boxes, one for its issuer
/// and one for the other resource. Shading takes so long that the ray tested last ends the run, and not the packet.
class OwnRays : public TimedRun {
 protected:
  Json run(const char* own_rays, std::vector<std::string> sets) {
    program_.write("rays.csv",
                   "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n"
                   "0,camera,0,0,900,0,0,1,0,inf\n"
                   "1,camera,0,0,900,0,0,1,0,inf\n");
    sets.push_back(fmt::format("testers.own_rays={}", own_rays));
    Json out = report(
        "scene: {builtin: terrain, triangles: 600}\n"
        "workload: {rays_from: rays.csv}\n"
        "topology: {resources: 2, link: {latency_cycles: 50, bytes_per_cycle: 8}}\n"
        "packets: {rays: 2, ids_per_cycle: 1}\n"
        "collections: {policy: fullest}\n"
        "rays: {placement: round_robin}\n"
        "testers: {box: {units: 8, latency_cycles: 100}}\n"
        "memory: {shared_by: 2}\n"
        "shading: {workers: 4, cycles_per_shade: 500}\n",
        std::move(sets));
    EXPECT_EQ(out["packets"]["issued"], 1u);
    EXPECT_EQ(out["rays"]["completed"], 2u);
    return out;
  }
  /// How much later the run ends if own rays come last.
  std::int64_t later(const std::vector<std::string>& sets = {}) {
    const auto cycles = [&](const char* own_rays) {
      return run(own_rays, sets)["engine"]["cycles"].get<std::int64_t>();
    };
    return cycles("after") - cycles("before");
  }
};

// Before: issue (2 IDs), own test, link, reading (2), other test. After: issue (2), link, reading (2), other test, link
// back, reading (2), own test. The first fetch misses the L2 that both share, and the second hits.
// The packet has 16 + 2 x 4 + 2 x 1 = 26 bytes, 4 cycles of a link of 8: the tail crosses it in 50 + 3.
TEST_F(OwnRays, ComeALinkAndAReadingLaterForALonelyPacket) {
  EXPECT_EQ(later(), 53 + 2);
  EXPECT_EQ(later({"topology.link.latency_cycles=70"}), 73 + 2);
  EXPECT_EQ(later({"topology.link.bytes_per_cycle=1"}), 50 + 25 + 2);
  EXPECT_EQ(later({"packets.ids_per_cycle=2"}), 53 + 1);
  EXPECT_EQ(later({"testers.box.latency_cycles=300", "memory.l2_latency_cycles=900"}), 53 + 2);
}

// The packet takes its shapes along, here a node of 256 bytes, and brings them back: 282 bytes are 36 cycles.
TEST_F(OwnRays, AreTestedAgainstTheShapesThatComeBack) {
  EXPECT_EQ(later({"packets.carry=data", "memory.fetch=packet"}), 50 + 35 + 2);
}

// The other's answer has 16 + 4 + 1 = 21 bytes, 3 cycles of the wire to the bus and of that from it. Dispatch reads its
// ID, and then the two of the packet.
TEST_F(OwnRays, WaitForTheLastAnswerOnABus) {
  EXPECT_EQ(later({"topology.shape=bus"}), 25 + 2 + 25 + 2 + 1 + 2);
}

// Where no packet leaves, own rays are all there are.
TEST_F(OwnRays, ComeAtOnceIfThePacketStays) {
  const std::vector<std::string> local{"collections.home=local"};
  EXPECT_EQ(later(local), 0);
  for (const char* own_rays : {"before", "after"}) EXPECT_EQ(bytes(run(own_rays, local), "packets"), 0u) << own_rays;
}

}  // namespace
}  // namespace carousel::own_rays_test

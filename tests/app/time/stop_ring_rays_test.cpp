// Packets of rays on rings whose stops have no queues.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::stop_ring_rays_test {
namespace {

class StopRingRays : public TimedRun {
 protected:
  /// A picture on six resources.
  Json picture(const std::string& links, std::vector<std::string> sets = {}) {
    return report(
        "scene: {builtin: spheres, triangles: 2000}\n"
        "image: {width: 24, height: 16, max_depth: 2}\n"
        "rays: {slots_per_resource: 64}\n"
        "topology: {shape: graph, nodes: [{name: r, count: 6}], links: [" +
            links + "]}\n",
        std::move(sets));
  }
  /// Two rays at two of three neighbours, and one packet at a time.
  std::uint64_t two_rays(const std::string& link, const std::string& more = "") {
    program_.write(
        "rays.csv",
        "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,0,900,0,0,1,0,inf\n1,camera,0,0,900,0,0,1,0,inf\n");
    return report(
        "scene: {builtin: terrain, triangles: 18}\nworkload: {rays_from: rays.csv}\n"
        "rays: {placement: round_robin}\npackets: {rays: 2}\n" +
        more + "topology: {shape: graph, link: {bytes_per_cycle: 4}, nodes: [{name: r, count: 3}], links: " +
        "[{ring: 'r[*]', both: true, " + link + "}]}\n")["engine"]["cycles"];
  }
  std::uint64_t traffic(const std::string& link, int wires) {
    return report(fmt::format("workload: {{traffic: {{sources: 'r[0]', destinations: 'r[1]', rate: 0.001, packets: 50, "
                              "packet_bytes: 28, inject_cycles: {}, eject_cycles: {}}}}}\n"
                              "topology: {{shape: graph, link: {{bytes_per_cycle: 4}}, nodes: [{{name: r, count: 3}}], "
                              "links: [{{ring: 'r[*]', both: true, {}}}]}}\n",
                              wires, wires, link),
                  {"topology.link.virtual_channels=2", "topology.channels=dateline"})["traffic"]["least_latency"];
  }
};

// The same hits as on a ring of queues, every ray is completed, and every packet that gets on gets off.
TEST_F(StopRingRays, HaveTheHitsOfAnyMachineAndLoseNothing) {
  const Json queues = picture("{ring: 'r[*]', both: true}");
  for (const char* stops :
       {"{rule: slots}", "{rule: slots, rings: 2, fair_after_cycles: 50}", "{rule: slots, port_bytes_per_cycle: 8}",
        "{rule: grants}", "{rule: grants, command_cycles: 2, transfers: 1, fair_after_cycles: 100}"})
    for (const char* both : {"true", "false"}) {
      SCOPED_TRACE(fmt::format("{} both: {}", stops, both));
      const Json ring = picture(fmt::format("{{ring: 'r[*]', both: {}, latency_cycles: 2, stops: {}}}", both, stops));
      EXPECT_EQ(ring["digest"], queues["digest"]);
      EXPECT_EQ(ring["rays"]["completed"], ring["rays"]["emitted"]);
      std::uint64_t on = 0, off = 0;
      for (const Json& link : ring["links"]) {
        if (ring["drawing"][link["to"].get<std::size_t>()]["name"] == "ring")
          on += link["packets"].get<std::uint64_t>();
        if (ring["drawing"][link["from"].get<std::size_t>()]["name"] == "ring")
          off += link["packets"].get<std::uint64_t>();
      }
      EXPECT_GT(on, 0u);
      EXPECT_EQ(on, off);
      EXPECT_EQ(ring["stops"]["starts"], on);
    }
}

TEST_F(StopRingRays, TakeTheSameCyclesOnAnyThreads) {
  const std::string links = "{ring: 'r[*]', both: true, stops: {rule: slots, port_bytes_per_cycle: 8}}";
  const Json one = picture(links), two = picture(links, {"engine.threads=2"});
  EXPECT_EQ(one["engine"]["cycles"], two["engine"]["cycles"]);
  EXPECT_EQ(one["links"], two["links"]);
}

// With nobody in the way a packet takes 1 + (F - 1 + h latency) + 1 cycles on a ring, and latency + F - 1 over a link.
// So a ring of links of 10 cycles takes a machine of rays as long as one of queued links of 12, and a network alone, in
// which a packet needs a cycle to get in and one to get out.
TEST_F(StopRingRays, TakeTheClosedFormAndTheTimeOfTraffic) {
  const std::uint64_t queues = two_rays("latency_cycles: 12");
  const std::string slots = "latency_cycles: 10, stops: {rule: slots}",
                    grants = "latency_cycles: 10, stops: {rule: grants, grant_cycles: 0}";
  EXPECT_EQ(two_rays(slots), queues);
  EXPECT_EQ(two_rays(grants), queues);
  EXPECT_EQ(two_rays("latency_cycles: 10, stops: {rule: grants, grant_cycles: 5}") - queues,
            (two_rays("latency_cycles: 17") - queues));
  EXPECT_EQ(traffic(slots, 1), traffic("latency_cycles: 12", 0));
  EXPECT_EQ(traffic(grants, 1), traffic("latency_cycles: 12", 0));
  // Half of the port's width for the flits of a packet: F more on the way on, and one more on the way off.
  EXPECT_GT(two_rays("latency_cycles: 10, stops: {rule: slots, port_bytes_per_cycle: 2}"), queues);
}

// A ring by another clock: nothing is early, and a slower ring is slower.
TEST_F(StopRingRays, GoByAClockOfTheirOwn) {
  const std::string slots = "latency_cycles: 10, stops: {rule: slots}";
  EXPECT_EQ(two_rays(slots, "clocks: {noc: 1000, synchroniser_cycles: 9}\n"), two_rays(slots));
  EXPECT_LT(two_rays(slots, "clocks: {noc: 2000, synchroniser_cycles: 0}\n"), two_rays(slots));
  EXPECT_GT(two_rays(slots, "clocks: {noc: 500, synchroniser_cycles: 0}\n"), two_rays(slots));
}

}  // namespace
}  // namespace carousel::stop_ring_rays_test

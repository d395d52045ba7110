// A central machine with a distributor in front of testers: the cycles of one packet by hand, and on whole pictures
// that nothing is lost and that each part costs what it is said to.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::distributor_test {
namespace {

class DistributorMachine : public TimedRun {};

// So many rays of one pixel that miss all there is: each is tested once, together with all others, against the boxes of
// the root's children. They lie in the slots from 0 on. Shapes and IDs take no time beside tests of 50 cycles.
std::string misses(int rays) {
  return fmt::format(
      "scene: {{builtin: cornell}}\nimage: {{width: 1, height: 1, samples: {}, max_depth: 1}}\n"
      "camera: {{eye: [0, 0, 100], target: [0, 0, 200]}}\n"
      "topology: {{shape: central, form: distributor, resources: 1, link: {{latency_cycles: 1, bytes_per_cycle: "
      "1024}}}}\n"
      "rays: {{slots_per_resource: 64}}\nshading: {{workers: 1, effects: []}}\n"
      "testers: {{box: {{units: 8, interval_cycles: 50, latency_cycles: 60}}, distributor: {{testers: 8, "
      "ids_per_cycle: "
      "64, queue: 64, results_per_cycle: 64, results: 64}}}}\n",
      rays);
}

TEST_F(DistributorMachine, TakesAsLongAsHandsCompute) {
  const auto cycles = [this](int rays, std::vector<std::string> sets = {}) {
    const Json r = report(misses(rays), sets);
    EXPECT_EQ(r["packets"]["issued"], 1);
    return r["engine"]["cycles"].get<std::uint64_t>();
  };
  // All boxes of a ray are tested at once, ray s by tester s modulo 8, one ray of a tester after another.
  const std::uint64_t at_once = cycles(8);
  EXPECT_EQ(cycles(8, {"testers.distributor.testers=4"}), at_once + 50);
  EXPECT_EQ(cycles(8, {"testers.distributor.testers=1"}), at_once + 7 * 50);
  EXPECT_EQ(cycles(8, {"testers.distributor.testers=5"}), at_once + 50);
  EXPECT_EQ(cycles(8, {"testers.box.latency_cycles=61"}), at_once + 1);
  // IDs leave one a cycle, and results go on one a cycle.
  EXPECT_EQ(cycles(8, {"testers.distributor.ids_per_cycle=1"}), at_once + 7);
  EXPECT_EQ(cycles(8, {"testers.distributor.ids_per_cycle=3"}), at_once + 2);
  EXPECT_EQ(cycles(8, {"testers.distributor.results_per_cycle=1"}), at_once + 7);
  // With one place, the second ID leaves when the first has been taken up and the place is known to be free. It is on
  // its way while the first ray is tested.
  EXPECT_EQ(cycles(8, {"testers.distributor.testers=4", "testers.distributor.queue=1"}), at_once + 50);
  // With one place for results, a second ray begins when the first one's result has gone: 60 cycles of its test, one to
  // the decision point and one back.
  EXPECT_EQ(cycles(8, {"testers.distributor.testers=4", "testers.distributor.results=1"}), at_once + 62);
}

struct Form {
  const char* scene;
  int width;
};

// On whole pictures: the same hits as a ring's, every ID has a result, and the parts are seen at work.
TEST_F(DistributorMachine, LosesNothingAndCountsWhatEachPartCosts) {
  for (const Form& form :
       {Form{"{builtin: terrain, triangles: 3000}", 16}, Form{"{builtin: terrain, triangles: 3000}", 40},
        Form{"{builtin: instances, triangles: 400, instances: 20}", 24}}) {
    for (const char* traversal : {"spread", "ordered"}) {
      const std::string machine = fmt::format(
          "scene: {}\nimage: {{width: {}, height: 16, samples: 1, max_depth: 3}}\n"
          "topology: {{resources: 1, link: {{latency_cycles: 2}}}}\npackets: {{rays: 32}}\n"
          "collections: {{traversal: {}}}\ntesters: {{contexts: 8}}\nmemory: {{fetch_ahead: 32, dram_latency_cycles: "
          "20}}\nenergy: {{profile: n45}}\n",
          form.scene, form.width, traversal);
      const std::vector<std::string> central{"topology.shape=central", "topology.form=distributor"};
      const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), central.begin(), central.end());
        return report(machine, more);
      };
      const auto counts = [](const Json& r) { return r["resources"][0]["units"]["distributor"]; };
      const Json ring = report(machine), wait = with({}), forward = with({"testers.distributor.stragglers=forward"}),
                 in_step = with({"testers.distributor.out_of_order=0"}),
                 far_ahead = with({"testers.distributor.out_of_order=7"}),
                 slow = with({"testers.distributor.results_per_cycle=1"});
      for (const Json& r : {wait, forward, in_step, far_ahead, slow}) {
        EXPECT_EQ(r["digest"], ring["digest"]);
        EXPECT_EQ(counts(r)["ids"], counts(r)["results"]);
        EXPECT_EQ(counts(r)["ids"], r["tests"]["ray_reads"]["count"]);
        EXPECT_EQ(bytes(r, "ray IDs"), 4 * counts(r)["ids"].get<std::uint64_t>());
        EXPECT_EQ(bytes(r, "shapes"), counts(r)["shape_bytes"]);
        EXPECT_GT(counts(r)["tester_busy"].get<std::uint64_t>(), 0u);
      }
      const auto cycles = [](const Json& r) { return r["engine"]["cycles"].get<double>(); };
      EXPECT_EQ(counts(wait)["parts"], counts(wait)["packets"]);
      EXPECT_GT(counts(forward)["parts"], counts(forward)["packets"]);
      EXPECT_EQ(counts(in_step)["ahead"], 0);
      EXPECT_GT(counts(far_ahead)["ahead"], 0);
      EXPECT_GT(counts(in_step)["held_back"], counts(far_ahead)["held_back"]);
      EXPECT_GT(cycles(in_step), 1.05 * cycles(far_ahead));
      EXPECT_GT(counts(slow)["undecided"], counts(wait)["undecided"]);
    }
  }
}

// Results of primitives do not take the time of the collection manager.
TEST_F(DistributorMachine, PrimitiveResultsGoPastTheCollections) {
  const std::string machine =
      "scene: {builtin: terrain, triangles: 3000}\nimage: {width: 24, height: 16, samples: 1}\n"
      "topology: {resources: 1}\npackets: {ids_per_cycle: 4}\ncollections: {traversal: spread}\n";
  for (const char* form : {"cells", "distributor"}) {
    const Json ring = report(machine),
               central = report(machine, {"topology.shape=central", fmt::format("topology.form={}", form)});
    const auto per_packet = [](const Json& r) {
      return r["resources"][0]["units"]["dispatch_busy"].get<double>() / r["packets"]["issued"].get<double>();
    };
    EXPECT_LT(per_packet(central), per_packet(ring)) << form;
    EXPECT_EQ(central["digest"], ring["digest"]);
  }
}

}  // namespace
}  // namespace carousel::distributor_test

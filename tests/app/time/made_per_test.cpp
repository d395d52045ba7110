// Packets made per child of a node that rays hit: a collection for each shape, and what that stores and costs.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::made_per_test {
namespace {

class MadePer : public TimedRun {
 protected:
  static std::uint64_t of(const Json& report, const char* key) { return report["collections"][key]; }
};

// Rays of one pixel that miss all there is wait at the root, and nowhere else.
TEST_F(MadePer, AChildHasACollectionOfItsOwn) {
  const std::string machine =
      "scene: {builtin: cornell}\nimage: {width: 1, height: 1, samples: 8, max_depth: 1}\n"
      "camera: {eye: [0, 0, 100], target: [0, 0, 200]}\ntopology: {resources: 1}\n"
      "packets: {shapes: single}\nshading: {effects: []}\n";
  const Json parent = report(machine), child = report(machine, {"packets.made_per=child"});
  const std::uint64_t shapes = parent["packets"]["issued"];
  ASSERT_GE(shapes, 2u);
  EXPECT_EQ(child["packets"]["issued"], shapes);
  EXPECT_EQ(of(parent, "created"), 1u);
  EXPECT_EQ(of(child, "created"), shapes);
  EXPECT_EQ(of(parent, "memberships_peak"), 8u);
  EXPECT_EQ(of(child, "memberships_peak"), 8 * shapes);
  EXPECT_EQ(parent["tests"]["box"]["count"], child["tests"]["box"]["count"]);
}

// On whole pictures: the same hits, on both engines; rays wait for each shape by themselves, so more IDs are stored.
TEST_F(MadePer, ChildStoresMoreAndFindsTheSame) {
  for (const char* scene :
       {"{builtin: terrain, triangles: 2000}", "{builtin: instances, triangles: 300, instances: 12}"}) {
    for (const int width : {12, 32}) {
      for (const char* home : {"issuer", "hash"}) {
        const std::string machine = fmt::format(
            "scene: {}\nimage: {{width: {}, height: 12, samples: 1, max_depth: 3}}\ntopology: {{resources: 4}}\n"
            "packets: {{shapes: single, ids_per_cycle: 4}}\n"
            "collections: {{home: {}, when_full: spill, sort_ids_per_cycle: 1}}\n",
            scene, width, home);
        const Json parent = report(machine), child = report(machine, {"packets.made_per=child"}),
                   native = report(
                       machine, {"packets.made_per=child", "collections.sort_ids_per_cycle=0", "engine.kind=native"});
        EXPECT_EQ(child["digest"], parent["digest"]) << machine;
        EXPECT_EQ(native["digest"], parent["digest"]) << machine;
        EXPECT_GT(of(child, "created"), of(parent, "created"));
        EXPECT_GT(of(child, "memberships_peak"), 2 * of(parent, "memberships_peak"));
      }
    }
  }
}

}  // namespace
}  // namespace carousel::made_per_test

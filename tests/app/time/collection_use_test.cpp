// Collections under virtual time: how many IDs there are at once, and how many rays ordered traversal admits.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::collection_use_test {
namespace {

class CollectionUse : public TimedRun {
 protected:
  static constexpr const char* kMachine =
      "scene: {builtin: terrain, triangles: 600}\n"
      "image: {width: 16, height: 12, samples: 1, max_depth: 3}\n"
      "topology: {resources: 4}\n"
      "packets: {rays: 16}\n"
      "collections: {ready: 16}\n"
      "rays: {slots_per_resource: 32}\n";
};

// Ordered traversal keeps each ray in one collection at a time, so there are never more IDs than slots.
TEST_F(CollectionUse, IdsAtOnceAreOfOneTime) {
  const Json run = report(kMachine, {"collections.traversal=ordered", "collections.select=strict"});
  std::uint64_t apart = 0;
  for (const Json& resource : run["resources"]) apart += resource["memberships_peak"].get<std::uint64_t>();
  const std::uint64_t together = run["collections"]["ids_at_once"], one = run["collections"]["memberships_peak"];
  EXPECT_LE(together, 4 * 32u);
  EXPECT_LE(together, apart);
  EXPECT_GE(together, 1u);
  EXPECT_LE(one, apart);
  EXPECT_GE(4 * one, apart);
  EXPECT_EQ(report(kMachine,
                   {"collections.traversal=ordered", "collections.select=strict", "engine.threads=3"})["collections"],
            run["collections"]);
}

TEST_F(CollectionUse, StallsOfTheNativeEngineStandInItsReportsAlone) {
  for (const Json& resource : report(kMachine)["resources"]) {
    EXPECT_FALSE(resource.contains("stalls"));
    EXPECT_TRUE(resource.contains("reserve_entered"));
  }
  const Json native = report(kMachine, {"engine.kind=native", "engine.threads=1"});
  EXPECT_FALSE(native["collections"].contains("ids_at_once"));
  for (const Json& resource : native["resources"]) {
    EXPECT_TRUE(resource.contains("stalls"));
    EXPECT_FALSE(resource.contains("reserve_entered"));
  }
}

// With a place for each slot, storage holds no ray back.
TEST_F(CollectionUse, OrderedTraversalAdmitsAsManyRaysAsThereArePlaces) {
  const auto run = [&](int capacity) {
    return report(kMachine, {"collections.traversal=ordered", fmt::format("collections.capacity={}", capacity)});
  };
  const Json ample = run(65536);
  EXPECT_EQ(run(4 * 32)["engine"], ample["engine"]);
  const Json tight = run(4);
  EXPECT_GT(tight["engine"]["cycles"], ample["engine"]["cycles"]);
  EXPECT_LE(tight["collections"]["memberships_peak"], 4);
  EXPECT_GT(tight["collections"]["memberships_peak"], 1);  // it was a block of packets.rays, 16, for each ray
  const Json one = run(1);                                 // one ray at a time at each resource
  for (const auto& [name, value] : ample["rays"].items()) {
    if (name != "residence") {  // a time
      EXPECT_EQ(one["rays"][name], value) << name;
    }
  }
}

}  // namespace
}  // namespace carousel::collection_use_test

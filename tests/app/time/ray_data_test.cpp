// Records of rays, states of paths and the film in memory (`memory.ray_records`, `path_state`, `film`), shapes that one
// fetch brings to several resources, and leaves in strips: the bytes, the cycles, and the same picture.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::ray_data_test {
namespace {

class RayDataInMemory : public TimedRun {};

const char* const kMachine =
    "scene: {builtin: terrain, triangles: 600}\nimage: {width: 16, height: 12, samples: 2, max_depth: 3}\n"
    "topology: {resources: 4}\npackets: {rays: 8}\ncollections: {ready: 8}\nrays: {slots_per_resource: 32}\n"
    "memory: {l2_kib: 8, shared_by: 2}\n";

TEST_F(RayDataInMemory, ChangesNoPicture) {
  const Json plain = report(kMachine);
  EXPECT_FALSE(plain["memory"].contains("ray_data"));
  for (const std::vector<std::string>& sets : std::vector<std::vector<std::string>>{
           {"memory.ray_records=master"},
           {"memory.path_state=memory", "memory.l2_write=back", "memory.l2_ray_ways=4"},
           {"memory.film=memory", "memory.l1_kib=4"},
           {"memory.ray_records=master", "memory.path_state=memory", "memory.film=memory", "topology.shape=independent",
            "memory.dram.preset=gddr6_14"},
           {"memory.ray_records=master", "bundles.size=4", "engine.threads=2"},
           {"memory.fetch=multicast", "memory.l2_answer_bytes_per_cycle=16"},
           {"bvh.leaves=strips", "bvh.storage=quantised"}}) {
    const Json r = report(kMachine, sets);
    EXPECT_EQ(r["digest"], plain["digest"]) << testing::PrintToString(sets);
    EXPECT_NE(r["engine"]["cycles"], plain["engine"]["cycles"]) << testing::PrintToString(sets);
  }
}

TEST_F(RayDataInMemory, MovesTheBytesOfEveryRayAndPath) {
  const Json r = report(kMachine, {"memory.ray_records=master", "memory.path_state=memory", "memory.film=memory"});
  const std::uint64_t rays = r["rays"]["completed"], paths = 16 * 12 * 2, state = r["shading"]["path_state_bytes"];
  const Json& data = r["memory"]["ray_data"];
  ASSERT_GT(rays, paths);
  EXPECT_EQ(data["records_read"], 64 * rays);
  EXPECT_EQ(data["records_written"], 2 * 64 * rays);
  EXPECT_EQ(data["states_read"], state * rays);
  EXPECT_EQ(data["states_written"], state * rays);
  EXPECT_EQ(data["film_read"], 16 * paths);
  EXPECT_EQ(data["film_written"], 16 * paths);
  // A request has 16 bytes, and one that writes its data besides.
  const std::uint64_t written = (128 + state) * rays + 16 * paths, requests = (3 + 2) * rays + 2 * paths;
  EXPECT_EQ(bytes(r, "requests of ray data"), 16 * requests + written);
}

// One ray. Ray control writes its record in three cycles of a wire of 32 bytes and asks for it in one, so the requests
// are at the L2 after 82 and 83 cycles. With l2_write: back the line is there a cycle after that, and is back 80 cycles
// later: 164 in all. With write-through it is fetched: 100 cycles to DRAM behind the line that is written, two of its
// cycles there, 100 and 80 back.
TEST_F(RayDataInMemory, DelaysARayByWritingAndReadingItsRecord) {
  const char* one =
      "scene: {builtin: terrain, triangles: 600}\nimage: {width: 1, height: 1, samples: 1, max_depth: 1}\n"
      "camera: {eye: [0, 9, 0], target: [0, 20, 1]}\ntopology: {resources: 2, link: {bytes_per_cycle: 32}}\n"
      "memory: {l2_latency_cycles: 160, dram_latency_cycles: 200, dram_bytes_per_cycle: 64}\n";
  const auto cycles = [&](std::vector<std::string> sets) {
    return report(one, std::move(sets))["engine"]["cycles"].get<std::int64_t>();
  };
  const std::int64_t plain = cycles({});
  EXPECT_EQ(cycles({"memory.ray_records=master", "memory.l2_write=back"}) - plain, 164);
  EXPECT_EQ(cycles({"memory.ray_records=master"}) - plain, 365);
}

// Written lines stay in the caches until they are replaced, and the last ones until the run is over.
TEST_F(RayDataInMemory, WrittenLinesReachMemoryAtTheEnd) {
  for (const char* preset : {"pipe", "gddr6_14"}) {
    const Json r = report(
        kMachine, {"memory.path_state=memory", "memory.l2_write=back", fmt::format("memory.dram.preset={}", preset)});
    const Json& drain = r["memory"]["drain"];
    std::uint64_t drained = 0, back = 0;
    for (const Json& cache : r["memory"]["caches"]) {
      drained += cache["drained"].get<std::uint64_t>();
      back += cache["written_back"].get<std::uint64_t>();
    }
    EXPECT_GT(drained, 0u);
    EXPECT_EQ(drain["lines"], drained);
    EXPECT_EQ(drain["bytes"], 64 * drained);
    EXPECT_GE(drain["cycles"].get<std::uint64_t>(), drained);  // at most 64 bytes are written a cycle
    EXPECT_EQ(bytes(r, "written lines"), 64 * (drained + back));
    EXPECT_EQ(r["memory"]["dram_lines_written"], back);
  }
  EXPECT_FALSE(report(kMachine)["memory"].contains("drain"));
}

TEST_F(RayDataInMemory, MulticastFetchesOnceForSeveral) {
  const std::vector<std::string> wide{"memory.shared_by=4"}, many{"memory.shared_by=4", "memory.fetch=multicast"};
  const Json alone = report(kMachine, wide), together = report(kMachine, many);
  EXPECT_LT(bytes(together, "shape data"), bytes(alone, "shape data"));
  const Json& buffers = together["memory"]["shape_buffers"];
  EXPECT_GT(buffers["pushed"].get<std::uint64_t>(), buffers["pushed_in_vain"].get<std::uint64_t>());
  EXPECT_EQ(together["memory"]["caches"][0]["pushed"], buffers["pushed"]);
  EXPECT_GT(bytes(together, "multicast shapes"), 0u);
}

// The terrain is a grid: most leaves of four triangles are rows, of 6 vertices instead of 12.
TEST_F(RayDataInMemory, StripsOfTrianglesSaveVertices) {
  const Json separate = report(kMachine), strips = report(kMachine, {"bvh.leaves=strips"});
  EXPECT_FALSE(separate["memory"].contains("triangle_strips"));
  const Json& use = strips["memory"]["triangle_strips"];
  const std::uint64_t triangles = use["triangles"], vertices = use["vertices"];
  EXPECT_GE(triangles, 500u);
  EXPECT_EQ(vertices, triangles + 2 * use["strips"].get<std::uint64_t>());
  EXPECT_EQ(use["bytes"], 12 * vertices + 4 * triangles);
  EXPECT_EQ(use["bytes_saved"], 40 * triangles - use["bytes"].get<std::uint64_t>());
  EXPECT_LT(bytes(strips, "lines"), bytes(separate, "lines"));
}

}  // namespace
}  // namespace carousel::ray_data_test

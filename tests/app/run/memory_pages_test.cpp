// Pages of what the shared caches ask the memory for (`memory.translation`), in whole machines.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/system/error.h"
#include "tests/app/time/timed_run.h"

namespace carousel::memory_pages_test {
namespace {

const char* const kMachine =
    "scene: {builtin: spheres, triangles: 3000}\nimage: {width: 24, height: 16, samples: 1, max_depth: 2}\n"
    "topology: {resources: 4}\nrays: {slots_per_resource: 64}\nmemory: {l2_kib: 16, shape_buffer_kib: 2, shared_by: "
    "2}\n";

class MemoryPages : public TimedRun {
 protected:
  static std::uint64_t sum(const Json& report, const char* key) {
    std::uint64_t out = 0;
    for (const Json& cache : report["memory"]["caches"]) out += cache[key].get<std::uint64_t>();
    return out;
  }
  static std::uint64_t cycles(const Json& report) { return report["engine"]["cycles"]; }
};

TEST_F(MemoryPages, AWalkReadsItsLevelsAndTakesTheirTime) {
  for (const char* more : {"memory.l2_write=through", "memory.l2_write=back", "memory.l1_kib=4",
                           "topology.shape=independent", "memory.dram.preset=gddr6_14"}) {
    SCOPED_TRACE(more);
    const std::vector<std::string> machine{more, "memory.film=memory", "memory.path_state=memory"};
    const auto with = [&](const std::string& pages) {
      std::vector<std::string> sets = machine;
      sets.push_back("memory.translation=" + pages);
      return report(kMachine, sets);
    };
    const Json physical = with("{page_bytes: 0}");
    EXPECT_EQ(sum(physical, "pages"), 0u);
    std::uint64_t before = 0;
    for (const auto& [pages, levels] : {std::pair{"{page_bytes: 1073741824}", 2},
                                        {"{page_bytes: 65536, entries: 8}", 4},
                                        {"{page_bytes: 4096, entries: 8}", 4}}) {
      SCOPED_TRACE(pages);
      const Json paged = with(pages);
      const std::uint64_t walks = sum(paged, "walks"), reads = sum(paged, "walk_reads");
      EXPECT_GT(walks, before) << "smaller pages are more";
      before = walks;
      EXPECT_EQ(reads, static_cast<std::uint64_t>(levels) * walks);
      EXPECT_EQ(sum(paged, "misses") + sum(paged, "write_fetches") + sum(paged, "written") + sum(paged, "written_back"),
                sum(paged, "pages"))
          << "each line that goes to the memory, but for what is left at the end";
      EXPECT_EQ(paged["memory"]["dram_lines"].get<std::uint64_t>(),
                sum(paged, "misses") + sum(paged, "write_fetches") + reads);
      EXPECT_GE(sum(paged, "page_misses"), walks);
      EXPECT_GE(sum(paged, "page_wait_cycles"), walks * 2 * 100) << "each walk waits for the memory";
      EXPECT_EQ(paged["digest"], physical["digest"]);
    }
    EXPECT_GT(cycles(with("{page_bytes: 4096, entries: 1}")), cycles(physical));
  }
}

TEST_F(MemoryPages, ATlbHasAnAreaAndTakesEnergy) {
  const auto with = [&](const char* pages) {
    return report(kMachine, {"energy.profile=n45", std::string("memory.translation=") + pages});
  };
  const Json none = with("{page_bytes: 0}"), small = with("{page_bytes: 4096, entries: 64}"),
             large = with("{page_bytes: 4096, entries: 128}");
  // Two L2s, and 16 bytes an entry.
  const auto kib = [](const Json& report) { return report["area"]["parts"]["l2"]["size"].get<double>(); };
  EXPECT_DOUBLE_EQ(kib(none), 32);
  EXPECT_DOUBLE_EQ(kib(small), 32 + 2 * 64 * 16 / 1024.0);
  EXPECT_DOUBLE_EQ(kib(large), 32 + 2 * 128 * 16 / 1024.0);
  const auto events = [](const Json& report) { return report["energy"]["parts"]["l2"]["events"].get<double>(); };
  const auto lines = static_cast<double>(sum(small, "lines") + small["memory"]["dram_lines"].get<std::uint64_t>()),
             pages = static_cast<double>(sum(small, "pages") + sum(small, "walks"));
  EXPECT_NEAR(events(small), 8 * lines + pages, 1)
      << "eight accesses of 64 bits for a line that is looked up or comes, and one for a page";
}

TEST_F(MemoryPages, WhatIsNoPageIsRefused) {
  const auto refused = [&](const std::string& set) {
    try {
      report(kMachine, {set});
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused("memory.translation.page_bytes=6000"),
              testing::HasSubstr("expected 0, or a power of two from 4096, found 6000"));
  EXPECT_THAT(refused("memory.translation.page_bytes=2048"), testing::HasSubstr("found 2048"));
  const Json ignored = report(kMachine, {"memory.translation.entries=8"});
  EXPECT_EQ(ignored["ignored_keys"], (std::vector<std::string>{"memory.translation.entries"}));
}

// Programs that meet no surface read nothing, so that their caches are of no use.
TEST_F(MemoryPages, CachesOfProgramsWithoutDataAreNamed) {
  const Json gaussians = report(
      "scene: {builtin: gaussians, gaussians: {count: 60}}\nimage: {width: 8, height: 8, samples: 1}\n"
      "topology: {resources: 2}\nrays: {query: {nearest: 8}}\n",
      {"shading.program.default=built_in", "shading.data_cache.bytes=4096", "shading.translation.page_bytes=4096"});
  const std::vector<std::string> named = gaussians["ignored_keys"];
  EXPECT_THAT(named, testing::IsSupersetOf({"shading.data_cache.bytes", "shading.translation.page_bytes"}));
  EXPECT_EQ(gaussians["shading"]["programs"]["data"]["lines"], 0);
  program_.write("rays.csv", "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n0,camera,0,1,3,0,0,-1,0,inf\n");
  const Json list = report("scene: {builtin: cornell}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 2}\n",
                           {"shading.program.default=built_in", "shading.data_cache.bytes=4096"});
  EXPECT_THAT(list["ignored_keys"].get<std::vector<std::string>>(), testing::Contains("shading.data_cache.bytes"));
  const Json picture = report(kMachine, {"shading.program.default=built_in", "shading.data_cache.bytes=4096"});
  EXPECT_TRUE(picture["ignored_keys"].empty()) << picture["ignored_keys"].dump();
}

}  // namespace
}  // namespace carousel::memory_pages_test

// Treelets of the whole tree (bvh.treelets): rays gather at connected pieces, a visit loads a piece once, and no
// machine changes a hit.
#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::whole_treelets_test {
namespace {

class WholeTreelets : public TimedRun {
 protected:
  static std::uint64_t bytes_of_shapes(const Json& report) { return bytes(report, "shape data"); }
  static Json answers(const Json& report) { return {report["digest"], report["rays"]["completed"]}; }
};

constexpr const char* kScenes[] = {"{builtin: terrain, triangles: 3000}", "{builtin: instances, instances: 20}",
                                   "{builtin: instances, instances: 60, levels: 4}"};

std::string machine_of(const char* scene) {
  return fmt::format(
      "scene: {}\nimage: {{width: 24, height: 16, samples: 1, max_depth: 3}}\ntopology: {{resources: 3}}\n"
      "memory: {{shape_buffer_kib: 256}}\n",
      scene);
}

TEST_F(WholeTreelets, ChangeNoAnswerInEitherEngine) {
  for (const char* scene : kScenes) {
    const std::string machine = machine_of(scene);
    const Json expected = answers(report(machine));
    int variant = 0;
    for (const char* engine : {"native", "cycle"})
      for (const char* traversal : {"spread", "ordered"})
        for (const char* bytes : {"1", "700", "4096", "1048576"}) {
          const std::string storage = variant % 2 == 0 ? "full" : "quantised";
          const std::string grouped = variant / 2 % 2 == 0 ? "true" : "false";
          ++variant;
          const Json with = report(
              machine, {fmt::format("engine.kind={}", engine), fmt::format("collections.traversal={}", traversal),
                        fmt::format("bvh.treelets.bytes={}", bytes), "bvh.storage=" + storage, "bvh.levels=4",
                        "collections.grouped=" + grouped});
          EXPECT_EQ(answers(with), expected) << scene << " " << engine << " " << traversal << " " << bytes;
        }
  }
}

// By hand: eight rays that meet the boxes of all three leaves below the root. The top level is the root of the mesh
// alone, so that rays begin in it. A node has 256 bytes, the leaves have 320, 160 and 320: all of them are one piece.
// Memory is read by lines of 64 bytes.
TEST_F(WholeTreelets, AVisitLoadsThePieceOnce) {
  std::string rays = "ray,kind,ox,oy,oz,dx,dy,dz,tmin,tmax\n";
  for (int i = 0; i < 8; ++i) rays += fmt::format("{},camera,-900,0,-900,1,0,1,0,inf\n", i);
  program_.write("rays.csv", rays);
  const auto run = [this](const char* bytes) {
    return report(
        "scene: {builtin: terrain, triangles: 18}\nworkload: {rays_from: rays.csv}\ntopology: {resources: 1}\n"
        "bvh: {width: 4, leaf_triangles: 16}\npackets: {rays: 8}\n",
        {fmt::format("bvh.treelets.bytes={}", bytes)});
  };
  const Json none = run("0"), whole = run("65536"), single = run("1");
  EXPECT_EQ(whole["digest"], none["digest"]);
  EXPECT_EQ(single["digest"], none["digest"]);
  EXPECT_EQ(bytes_of_shapes(none), 64 * (4 + 5 + 3 + 6));  // leaves stand one behind another, and share lines
  EXPECT_EQ(whole["packets"]["issued"], 1);
  EXPECT_EQ(bytes_of_shapes(whole), 64 * 17);
  EXPECT_EQ(whole["structure"]["treelets"]["largest"], 256 + 800);
  // Every node is a piece by itself: visits as without.
  EXPECT_EQ(single["packets"]["issued"], none["packets"]["issued"]);
  EXPECT_EQ(bytes_of_shapes(single), 64 * (4 + 5 + 3 + 5));  // each begins with a line of its own
}

TEST_F(WholeTreelets, LargerPiecesMakeFewerVisits) {
  for (const char* traversal : {"spread", "ordered"}) {
    std::uint64_t before = ~0ull;
    for (const int bytes : {1, 1024, 8192, 65536}) {
      const Json with = report(machine_of(kScenes[0]), {fmt::format("collections.traversal={}", traversal),
                                                        fmt::format("bvh.treelets.bytes={}", bytes)});
      std::uint64_t visits = 0;
      for (const Json& resource : with["resources"]) visits += resource["rays_tested"].get<std::uint64_t>();
      EXPECT_LT(visits, before) << traversal << " " << bytes;
      before = visits;
    }
  }
}

TEST_F(WholeTreelets, GroupedPacketsAreFuller) {
  for (const char* traversal : {"spread", "ordered"}) {
    const auto run = [&](const char* grouped) {
      return report(machine_of(kScenes[0]),
                    {fmt::format("collections.traversal={}", traversal), "bvh.treelets.bytes=1024",
                     "collections.home=local", fmt::format("collections.grouped={}", grouped)});
    };
    const Json alone = run("false"), grouped = run("true");
    EXPECT_EQ(grouped["digest"], alone["digest"]);
    EXPECT_GT(grouped["packets"]["rays_mean"].get<double>(), 1.5 * alone["packets"]["rays_mean"].get<double>());
    EXPECT_LT(grouped["packets"]["issued"].get<int>(), alone["packets"]["issued"].get<int>());
  }
}

}  // namespace
}  // namespace carousel::whole_treelets_test

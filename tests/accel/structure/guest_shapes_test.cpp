#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "accel/build/build.h"
#include "accel/build/rank_shares.h"
#include "accel/traverse/kernels.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "scene/builtin/builtin.h"

namespace carousel::accel {
namespace {

scene::Scene partitioned_scene() {
  SceneConfig config;
  config.builtin = BuiltinScene::kInstances;
  config.instances = 40;
  return scene::make_builtin(config);
}

/// The structures of `ranks` ranks that are built one after another: in a first round they only tell what they have.
std::vector<Accel> partitioned(const scene::Scene& scene, const BvhConfig& config, std::uint32_t ranks) {
  std::vector<std::string> told(ranks);
  std::vector<Accel> out;
  for (int round = 0; round < 2; ++round) {
    out.clear();
    for (std::uint32_t r = 0; r < ranks; ++r) {
      const BuildRanks all{r, ranks, [&](const std::string& bytes) {
                             told[r] = bytes;
                             return told;
                           }};
      out.push_back(build(scene, config, *make_tbb_executor(1), {}, {}, &all));
    }
  }
  return out;
}

TEST(ShareMeshes, KeepsTheSharesAboutEqual) {
  const std::vector<std::uint64_t> sizes{10, 70, 20, 30, 10, 60};
  const std::vector<std::uint32_t> home = share_meshes(sizes, 3);
  std::vector<std::uint64_t> load(3);
  for (std::size_t i = 0; i < sizes.size(); ++i) load.at(home[i]) += sizes[i];
  EXPECT_EQ(load, (std::vector<std::uint64_t>{70, 70, 60}));
}

TEST(Partition, HasEachShapeAtOneRankAndTheTopLevelAtAll) {
  const scene::Scene scene = partitioned_scene();
  const Accel whole = build(scene, {}, *make_tbb_executor(1));
  const std::vector<Accel> parts = partitioned(scene, {}, 3);
  std::size_t nodes = 0, blocks = 0;
  for (const Accel& part : parts) {
    const Partition& partition = *part.partition;
    EXPECT_EQ(part.nodes.size(), whole.nodes.size());
    nodes += partition.node_begin[partition.rank + 1] - partition.node_begin[partition.rank];
    blocks += part.blocks.here();
    EXPECT_LT(part.blocks.here(), whole.blocks.size());
    for (std::size_t i = 0; i < part.instances.size(); ++i)
      EXPECT_EQ(part.instances[i].root, parts[0].instances[i].root);
    for (std::uint32_t i = partition.node_begin.back(); i < part.nodes.size(); ++i)
      EXPECT_EQ(partition.home(NodeRef::inner(i)), std::nullopt);
  }
  EXPECT_EQ(nodes, parts[0].partition->node_begin.back());
  EXPECT_EQ(blocks, whole.blocks.size());
}

/// A ray from outside through the middle of each instance's mesh.
RayRecord through(const Accel& accel, std::uint32_t instance) {
  RayRecord record;
  const Aabb& box = accel.instances[instance].world;
  const Vec3 middle = (box.lo + box.hi) * 0.5f;
  record.ray.origin = middle + Vec3{0.3f, 10, 0.2f};
  record.ray.direction = middle - record.ray.origin;
  record.hit.t = kInfinity;
  return record;
}

TEST(GuestShapes, AreHitAsWhereTheyComeFrom) {
  const scene::Scene scene = partitioned_scene();
  BvhConfig config;
  config.mixed_triangles = 2;
  std::vector<Accel> parts = partitioned(scene, config, 2);
  for (Accel& part : parts) part.guests->set_places(3, {4096, 4096});
  std::vector<std::uint64_t> words, again;
  int hits = 0;
  for (std::uint32_t i = 0; i < parts[0].instances.size(); ++i) {
    const NodeRef root = parts[0].instances[i].root;
    const std::uint32_t home = *parts[0].partition->home(root);
    Accel& from = parts[home];
    Accel& to = parts[1 - home];
    words.clear();
    pack_shapes(from, root, true, words);
    // From where they are guests they go on as they came.
    const NodeRef guest = to.guests->enter(i % 3, words);
    again.clear();
    pack_shapes(to, guest, true, again);
    EXPECT_EQ(again, words);
    RayRecord own = through(from, i), other = own;
    IntersectionCounts own_counts, other_counts;
    trace_subtree(from, {i, root}, {.records = &own, .count = 1}, own_counts);
    trace_subtree(to, {i, guest}, {.records = &other, .count = 1}, other_counts);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(other.hit.t), std::bit_cast<std::uint32_t>(own.hit.t));
    EXPECT_EQ(other.hit.primitive, own.hit.primitive);
    EXPECT_EQ(other_counts, own_counts);
    hits += own.hit.valid();
  }
  EXPECT_GT(hits, 10);
  EXPECT_GT(parts[0].guests->bytes(), 0u);
}

TEST(GuestShapes, RefuseWhatIsCutOffOrTooLarge) {
  std::vector<Accel> parts = partitioned(partitioned_scene(), {}, 2);
  std::vector<std::uint64_t> words;
  const NodeRef root = parts[0].instances[0].root;
  const std::uint32_t home = *parts[0].partition->home(root);
  pack_shapes(parts[home], root, true, words);
  GuestShapes& guests = *parts[1 - home].guests;
  guests.set_places(1, {1, 1});
  EXPECT_THROW(guests.enter(0, words), SimulationError);
  guests.set_places(1, {4096, 4096});
  EXPECT_THROW(guests.enter(0, std::span(words).first(words.size() - 1)), SimulationError);
  EXPECT_THROW(guests.enter(0, {}), SimulationError);
  guests.enter(0, words);
  EXPECT_THROW(guests.set_places(1u << 31, {1, 1}), SimulationError);
}

}  // namespace
}  // namespace carousel::accel

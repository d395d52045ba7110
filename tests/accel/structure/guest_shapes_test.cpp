#include <algorithm>
#include <barrier>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "accel/builders/mesh/mesh_pieces.h"
#include "accel/builders/rank_shares.h"
#include "accel/measure/structure_size.h"
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

/// The structures of ranks that are threads.
std::vector<Accel> partitioned(const scene::Scene& scene, const BvhConfig& config, std::uint32_t ranks) {
  std::vector<std::string> told(ranks);
  std::vector<Accel> out(ranks);
  std::barrier all_here(static_cast<std::ptrdiff_t>(ranks));
  std::vector<std::jthread> threads;
  for (std::uint32_t r = 0; r < ranks; ++r)
    threads.emplace_back([&, r] {
      const BuildRanks all{r, ranks, [&, r](const std::string& bytes) {
                             told[r] = bytes;
                             all_here.arrive_and_wait();
                             return told;
                           }};
      out[r] = build(scene, config, *make_tbb_executor(1), {}, {}, &all);
    });
  threads.clear();
  return out;
}

TEST(ShareMeshes, KeepsTheSharesAboutEqual) {
  const std::vector<std::uint64_t> sizes{10, 70, 20, 30, 10, 60};
  const std::vector<std::uint32_t> home = share_meshes(sizes, 3);
  std::vector<std::uint64_t> load(3);
  for (std::size_t i = 0; i < sizes.size(); ++i) load.at(home[i]) += sizes[i];
  EXPECT_EQ(load, (std::vector<std::uint64_t>{70, 70, 60}));
}

TEST(ShareMeshes, DividesThoseThatAreLarge) {
  const scene::Scene scene = partitioned_scene();
  const scene::Mesh& mesh = scene.meshes[1];
  std::vector<bool> found(mesh.triangle_count());
  for (const MeshPiece& piece : divide_mesh(mesh, 100)) {
    EXPECT_LE(piece.size(), 100u);
    EXPECT_GT(piece.size(), 40u);
    EXPECT_TRUE(std::is_sorted(piece.begin(), piece.end()));
    for (const std::uint32_t primitive : piece) {
      EXPECT_FALSE(found.at(primitive));
      found.at(primitive) = true;
    }
  }
  EXPECT_EQ(std::count(found.begin(), found.end(), false), 0);
}

TEST(Partition, HasEachShapeAtOneRankAndTheTopLevelAtAll) {
  const scene::Scene scene = partitioned_scene();
  const Accel whole = build(scene, {}, *make_tbb_executor(1));
  const std::vector<Accel> parts = partitioned(scene, {}, 3);
  StructureSize sum;
  std::size_t blocks = 0;
  for (const Accel& part : parts) {
    const Partition& partition = *part.partition;
    EXPECT_EQ(part.nodes.size(), parts[0].nodes.size());
    blocks += part.blocks.here();
    EXPECT_LT(part.blocks.here(), whole.blocks.size() / 2);
    for (std::size_t i = 0; i < part.instances.size(); ++i)
      EXPECT_EQ(part.instances[i].root, parts[0].instances[i].root);
    for (std::uint32_t i = partition.node_begin.back(); i < part.nodes.size(); ++i) {
      EXPECT_EQ(partition.home(NodeRef::inner(i)), std::nullopt);
      EXPECT_TRUE(partition.above(NodeRef::inner(i)));
      EXPECT_EQ(std::memcmp(&part.nodes[i].child, &parts[0].nodes[i].child, sizeof part.nodes[i].child), 0);
    }
    const StructureSize size = structure_size(part);
    sum.primitives += size.primitives;
    sum.references += size.references;
    sum.surface_cost += size.surface_cost;
  }
  EXPECT_EQ(blocks, parts[0].blocks.size());
  const StructureSize all = structure_size(whole);
  EXPECT_EQ(sum.primitives, all.primitives);
  EXPECT_EQ(sum.references, all.references);
  EXPECT_NEAR(sum.surface_cost / all.surface_cost, 1, 0.3);
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
    NodeRef root = parts[0].instances[i].root;
    while (!parts[0].partition->home(root)) root = parts[0].nodes[root.node()].child[0];  // a divided mesh has no home
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
  NodeRef root = parts[0].instances[0].root;
  while (!parts[0].partition->home(root)) root = parts[0].nodes[root.node()].child[0];
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

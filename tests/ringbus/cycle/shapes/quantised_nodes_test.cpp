// Nodes with boxes in 8 bits a plane: they contain the full ones, change no hit, and have the bytes of their formats.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "accel/box/slab.h"
#include "accel/builders/quantised_boxes.h"
#include "accel/traverse/kernels.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "tests/ringbus/support/timed_machine.h"

namespace carousel::ringbus {
namespace {

BvhConfig bvh_of(std::int64_t width, BvhConfig::Storage storage) {
  BvhConfig bvh;
  bvh.width = width;
  bvh.storage = storage;
  return bvh;
}

TEST(QuantisedNodes, BoxesContainTheFullOnesAndFit8Bits) {
  for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kInstances, BuiltinScene::kSliver}) {
    TestScene scene(builtin_scene(builtin, 3000, 20), 1, 1);
    const accel::Accel& full = scene.accel(bvh_of(6, BvhConfig::Storage::kFull));
    accel::Accel small = full;
    accel::quantise_boxes(small, 8);
    const std::vector<std::uint32_t> kept = accel::unquantised_nodes(full);
    EXPECT_EQ(kept.empty(), builtin == BuiltinScene::kTerrain || builtin == BuiltinScene::kSliver);
    std::size_t wider = 0;
    for (std::uint32_t n = 0; n < full.nodes.size(); ++n) {
      const accel::Node &a = full.nodes[n], &b = small.nodes[n];
      if (std::find(kept.begin(), kept.end(), n) != kept.end()) {
        EXPECT_TRUE(std::equal(&a.plane[0][0], &a.plane[0][0] + 6 * accel::kMaxWidth, &b.plane[0][0]));
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        float origin = std::numeric_limits<float>::infinity(), end = -origin;
        for (int lane = 0; lane < a.count; ++lane) {
          ASSERT_LE(b.plane[axis][lane], a.plane[axis][lane]);
          ASSERT_GE(b.plane[axis + 3][lane], a.plane[axis + 3][lane]);
          wider += b.plane[axis + 3][lane] > a.plane[axis + 3][lane];
          origin = std::min(origin, a.plane[axis][lane]);
          end = std::max(end, a.plane[axis + 3][lane]);
        }
        // The step is the least power of two of which 255 reach across; each plane is a multiple, up to its rounding.
        double step = std::numeric_limits<float>::denorm_min();
        while (255 * step < double{end} - origin) step *= 2;
        for (int side = 0; side < 2; ++side)
          for (int lane = 0; lane < a.count; ++lane) {
            const float plane = b.plane[axis + 3 * side][lane];
            const double steps = std::round((double{plane} - origin) / step), exact = origin + steps * step;
            EXPECT_GE(steps, 0);
            EXPECT_LE(steps, 255);
            EXPECT_LE(std::abs(plane - exact), std::nextafter(std::abs(plane), 1e38f) - std::abs(plane));
          }
      }
      for (int lane = a.count; lane < accel::kMaxWidth; ++lane) EXPECT_EQ(b.plane[0][lane], a.plane[0][lane]);
    }
    EXPECT_GT(wider, 0u);
  }
}

TEST(QuantisedNodes, HaveTheBytesOfTheirFormats) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 500, 0), 1, 1);
  for (const auto& [width, bytes] : {std::pair{6, 64u}, std::pair{8, 80u}}) {
    const BvhConfig bvh = bvh_of(width, BvhConfig::Storage::kQuantised);
    const accel::Accel& accel = scene.accel(bvh);
    const cycle::ShapeMemory memory(accel, AccuracyConfig{}, bvh);
    std::uint64_t leaves_end = 0, leaf_bytes = 0;
    for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) {
      const cycle::ShapeSpan node = memory.strip({kNoInstance, accel::NodeRef::inner(n)});
      EXPECT_EQ(node, (cycle::ShapeSpan{std::uint64_t{n} * bytes, bytes}));
      for (int lane = 0; lane < accel.nodes[n].count; ++lane) {
        const accel::NodeRef child = accel.nodes[n].child[lane];
        if (child.is_inner() || child.is_instance()) continue;
        const cycle::ShapeSpan leaf = memory.strip({kNoInstance, child});
        EXPECT_EQ(leaf.bytes, 64 * child.triangles());
        EXPECT_EQ(leaf.address % 64, 0u);
        EXPECT_GE(leaf.address, accel.nodes.size() * bytes);
        leaves_end = std::max(leaves_end, leaf.address + leaf.bytes);
        leaf_bytes += leaf.bytes;
      }
    }
    // Leaves lie side by side without a gap.
    EXPECT_EQ(leaves_end - (accel.nodes.size() * bytes + 63) / 64 * 64, leaf_bytes);
  }
}

TEST(QuantisedNodes, HaveTheBytesOfFullOnesAboveTurnedInstances) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 60), 1, 1);
  const BvhConfig bvh = bvh_of(8, BvhConfig::Storage::kQuantised);
  const accel::Accel& accel = scene.accel(bvh);
  const cycle::ShapeMemory memory(accel, AccuracyConfig{}, bvh);
  const std::vector<std::uint32_t> kept = accel::unquantised_nodes(accel);
  ASSERT_FALSE(kept.empty());
  std::uint64_t end = 0;
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) {
    const bool full = std::find(kept.begin(), kept.end(), n) != kept.end();
    const cycle::ShapeSpan node = memory.strip({kNoInstance, accel::NodeRef::inner(n)});
    EXPECT_EQ(node, (cycle::ShapeSpan{end, full ? 256u : 80u}));
    end += node.bytes;
  }
}

TEST(QuantisedNodes, ChangeNoHitAndFetchLess) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 6000, 0), 300, 1);
  const std::string machine =
      "topology: {resources: 4}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
      "memory: {l2_kib: 8, shape_buffer_kib: 4}\nbvh: {leaf_triangles: 1, ";
  for (const std::string width : {"6", "8"}) {
    const Outcome full = run_text(scene, machine + "width: " + width + "}\n"),
                  small = run_text(scene, machine + "width: " + width + ", storage: quantised}\n");
    // run_text() has compared the hits with the reference tracer's.
    EXPECT_LT(small.result.cycle->memory.lines, full.result.cycle->memory.lines);
  }
}

/// The boxes of both structures one by one, in the scalar test, against the counter of the vector kernels.
TEST(QuantisedNodes, CountBoxesThatOnlyRoundingHits) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 2000, 0), 60, 1);
  const accel::Accel& full = scene.accel(bvh_of(8, BvhConfig::Storage::kFull));
  accel::Accel small = full;
  accel::quantise_boxes(small, 8);
  std::mt19937 random(7);
  const auto corner = [&] {  // a corner of any child
    const accel::Node& node = full.nodes[random() % full.nodes.size()];
    const auto lane = static_cast<std::size_t>(random() % node.count);
    return Vec3{node.plane[0][lane], node.plane[4][lane], node.plane[2][lane]};
  };
  std::uint64_t expected = 0;
  IntersectionCounts counts;
  for (int i = 0; i < 2000; ++i) {
    RayRecord record;
    const Vec3 from = corner(), to = corner();
    if (from == to) continue;
    record.ray.origin = from - (to - from);
    record.ray.direction = glm::normalize(to - from);
    const accel::SlabRay slab(record.ray);
    for (std::uint32_t n = 0; n < small.nodes.size(); ++n) {
      const auto hits_of = [&](const accel::Accel& accel, int lane) {
        const auto& plane = accel.nodes[n].plane;
        const Aabb box{{plane[0][lane], plane[1][lane], plane[2][lane]},
                       {plane[3][lane], plane[4][lane], plane[5][lane]}};
        float entry = 0;
        return accel::slab(slab, box, record.hit.t, entry);
      };
      for (int lane = 0; lane < small.nodes[n].count; ++lane) expected += hits_of(small, lane) && !hits_of(full, lane);
      std::uint8_t mask = 0;
      std::array<float, accel::kMaxWidth> nearest{};
      accel::test_strip(small, {kNoInstance, accel::NodeRef::inner(n)}, ~0u, {&record, nullptr, 1},
                        {&mask, nearest.data()}, counts);
    }
  }
  EXPECT_GT(expected, 100u);
  EXPECT_EQ(counts.extra_box_hits, expected);
}

TEST(QuantisedNodes, AreRefusedWhereTheyCannotHoldANode) {
  const std::string scene = "scene: {builtin: cornell}\nbvh: {storage: quantised";
  for (const auto& [more, key] : {std::pair{", elements: spheres}\n", "bvh.elements"},
                                  std::pair{", mixed_triangles: 4}\n", "bvh.mixed_triangles"},
                                  std::pair{"}\npackets: {shapes: single}\n", "packets.shapes"},
                                  std::pair{"}\naccuracy: {box: plain}\n", "accuracy.box"}}) {
    try {
      load_config({scene + more, "a.yaml"});
      ADD_FAILURE() << more;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string(key) + ": "), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus

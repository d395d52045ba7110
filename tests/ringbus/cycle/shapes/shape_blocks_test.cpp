// Blocks of the simulated memory by which collections are keyed: which nodes share one, and what a visit reads.
#include "ringbus/cycle/shapes/shape_blocks.h"

#include <map>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "accel/builders/build.h"
#include "core/system/executor.h"
#include "tests/ringbus/support/test_scene.h"

namespace carousel::ringbus::cycle::shape_blocks_test {
namespace {

std::vector<accel::NodeRef> nodes_below(const accel::Accel& accel) {
  std::vector<accel::NodeRef> out;
  std::set<std::uint64_t> seen;
  std::vector<accel::NodeKey> open{accel.root_key()};
  while (!open.empty()) {
    const accel::NodeKey key = open.back();
    open.pop_back();
    if (!seen.insert(key.bits()).second) continue;
    out.push_back(key.ref);
    if (!key.ref.is_inner()) continue;
    const accel::Node& node = accel.nodes[key.ref.node()];
    for (int lane = 0; lane < node.count; ++lane)
      if ((node.direct >> lane & 1) == 0) open.push_back(accel.child_key(key, lane));
  }
  return out;
}

class ShapeBlocksTest : public testing::TestWithParam<const char*> {
 protected:
  static BvhConfig config(std::string_view form) {
    BvhConfig out;
    if (form == "quantised") out.storage = BvhConfig::Storage::kQuantised;
    if (form == "strips") out.leaves = BvhConfig::Leaves::kStrips;
    if (form == "direct") out.mixed_triangles = out.top_triangles = 4;
    return out;
  }
};

// Two nodes have one name exactly if they begin in the same block and are of one kind; a visit reads from the first of
// them to the end of the last.
TEST_P(ShapeBlocksTest, AreThoseInWhichNodesBegin) {
  const BvhConfig bvh = config(GetParam());
  for (const BuiltinScene builtin : {BuiltinScene::kInstances, BuiltinScene::kSpheres}) {
    const accel::Accel accel = accel::build(builtin_scene(builtin, 500, 12), bvh, *make_sequential_executor());
    const ShapeMemory memory(accel, {}, bvh);
    for (const std::uint64_t bytes : {64u, 1000u, 4096u, 1u << 20}) {
      const ShapeBlocks blocks(accel, memory, bytes);
      struct Expected {
        std::uint64_t first = ~0ull, end = 0;
        std::set<std::uint32_t> names;
      };
      std::map<std::pair<bool, std::uint64_t>, Expected> expected;
      std::set<std::uint32_t> names;
      const std::vector<accel::NodeRef> all = nodes_below(accel);
      for (const accel::NodeRef ref : all) {
        const ShapeSpan strip = memory.strip({kNoInstance, ref});
        Expected& block = expected[{ref.is_inner(), strip.address / bytes}];
        block.first = std::min(block.first, strip.address);
        block.end = std::max(block.end, strip.address + strip.bytes);
        const accel::NodeKey name = blocks.name({7, ref});
        EXPECT_EQ(name.instance, 7u);
        EXPECT_EQ(name.ref.is_inner(), ref.is_inner());
        block.names.insert(name.ref.bits());
        names.insert(name.ref.bits());
      }
      EXPECT_EQ(names.size(), expected.size()) << bytes;
      for (const accel::NodeRef ref : all) {
        const ShapeSpan strip = memory.strip({kNoInstance, ref});
        const Expected& block = expected[{ref.is_inner(), strip.address / bytes}];
        EXPECT_EQ(block.names.size(), 1u);
        EXPECT_EQ(blocks.span(ref), (ShapeSpan{block.first, static_cast<std::uint32_t>(block.end - block.first)}));
        EXPECT_EQ(blocks.span(blocks.name({0, ref}).ref), blocks.span(ref));
      }
      EXPECT_LE(names.size(), all.size());
      if (bytes > 64) {
        EXPECT_LT(names.size(), all.size());
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Forms, ShapeBlocksTest, testing::Values("full", "quantised", "strips", "direct"));

}  // namespace
}  // namespace carousel::ringbus::cycle::shape_blocks_test

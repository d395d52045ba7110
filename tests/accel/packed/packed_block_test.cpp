// Compressed blocks of triangles: what was put in comes out, to the bit, and 128 bytes hold what they should.
#include "accel/packed/packed_block.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "accel/packed/packed_leaves.h"
#include "scene/model/quantise.h"
#include "tests/accel/structure/test_scenes.h"

namespace carousel::accel {
namespace {

PackedTriangle triangle_of(const std::array<Vec3, 3>& corners, std::uint32_t primitive) {
  PackedTriangle out;
  out.primitive = primitive;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      out.vertex[i][axis] = std::bit_cast<std::uint32_t>(corners[i][static_cast<int>(axis)]);
  return out;
}

/// Two triangles a cell of a grid, row by row, at several heights or flat; each a primitive of its own or all one.
std::vector<PackedTriangle> sheet(int columns, int rows, bool flat, bool one_primitive) {
  std::vector<PackedTriangle> out;
  const auto corner = [&](int x, int y) {
    const int height = flat ? 0 : 100 * (x * y % 3);
    return Vec3{3, -2, 1} + 0.25f * Vec3{static_cast<float>(x), static_cast<float>(y), static_cast<float>(height)};
  };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const auto number = one_primitive ? 7 : static_cast<std::uint32_t>(out.size());
      out.push_back(triangle_of({corner(x, y), corner(x + 1, y), corner(x, y + 1)}, number));
      out.push_back(triangle_of({corner(x + 1, y + 1), corner(x, y + 1), corner(x + 1, y)}, number + !one_primitive));
    }
  return out;
}

TEST(PackedBlock, HoldsSixtyFourTrianglesAtMost) {
  std::vector<PackedTriangle> triangles = sheet(8, 4, true, true);
  order_in_strips(triangles);
  const std::optional<PackedBlock> block = encode_block(triangles);
  ASSERT_TRUE(block);
  EXPECT_FALSE(block->raw);
  EXPECT_EQ(block->triangles, 64u);
  EXPECT_EQ(block->vertices, 45u);
  EXPECT_EQ(decode_block(block->bits), triangles);
  triangles.push_back(triangles[0]);
  EXPECT_FALSE(encode_block(triangles));
}

// With their numbers and heights, 64 triangles have more than 1,024 bits.
TEST(PackedBlock, HoldsNoMoreBitsThanItHas) {
  std::vector<PackedTriangle> triangles = sheet(8, 4, false, false);
  order_in_strips(triangles);
  EXPECT_FALSE(encode_block(triangles));
  while (!encode_block(triangles)) triangles.pop_back();
  EXPECT_GT(triangles.size(), 16u);
  EXPECT_EQ(decode_block(encode_block(triangles)->bits), triangles);
}

TEST(PackedBlock, LosesNoBitAnywhereOnAGrid) {
  std::mt19937 random(1);
  std::size_t packed = 0;
  for (int round = 0; round < 4000; ++round) {
    const int exponent = static_cast<int>(random() % 200) - 120;
    const std::uint32_t reach = 1u << (1 + random() % 23);
    const auto coordinate = [&] {
      return std::ldexp(static_cast<float>(static_cast<std::int32_t>(random() % reach) - static_cast<int>(reach / 2)),
                        exponent);
    };
    std::vector<Vec3> points(3 + random() % 20);
    for (Vec3& point : points) point = {coordinate(), coordinate(), coordinate()};
    std::vector<PackedTriangle> triangles(1 + random() % 8);
    const std::uint32_t base = static_cast<std::uint32_t>(random()) & (kPrimitiveMask >> 1);
    for (PackedTriangle& triangle : triangles) {
      const auto point = [&] { return points[random() % points.size()]; };
      triangle = triangle_of({point(), point(), point()}, base + random() % (1u << random() % 20));
      if (round % 3 == 0 && random() % 2 == 0) triangle.primitive |= kNonOpaqueBit;
    }
    order_in_strips(triangles);
    const std::optional<PackedBlock> block = encode_block(triangles);
    if (!block) continue;
    packed += !block->raw;
    ASSERT_EQ(decode_block(block->bits), triangles) << round;
  }
  EXPECT_GT(packed, 1000u);
}

TEST(PackedBlock, KeepsWhatIsOnNoGridAsItIs) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  for (const Vec3& odd : {Vec3{-0.0f, 1, 1}, Vec3{kInfinite, 0, 0}, Vec3{1e30f, 1, 0}, Vec3{1e-40f, 1, 1},
                          Vec3{std::numeric_limits<float>::quiet_NaN(), 0, 0}}) {
    std::vector<PackedTriangle> triangles;
    for (std::uint32_t i = 0; i < 3; ++i)
      triangles.push_back(triangle_of({odd, {1, 2, 3}, {0.5f, static_cast<float>(i), 7}}, i | kNonOpaqueBit));
    const std::optional<PackedBlock> block = encode_block(triangles);
    ASSERT_TRUE(block);
    EXPECT_TRUE(block->raw);
    EXPECT_EQ(decode_block(block->bits), triangles);
    triangles.push_back(triangles[0]);
    EXPECT_FALSE(encode_block(triangles));  // there is room for three
  }
}

/// Neighbours that turn the same way, in every order of their own vertices.
TEST(PackedBlock, KeepsTheOrderOfAllVertices) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{1, 1, 1};
  for (int first = 0; first < 3; ++first)
    for (int second = 0; second < 6; ++second) {
      std::array<Vec3, 3> one{a, b, c}, other{b, d, c};
      std::rotate(one.begin(), one.begin() + first, one.end());
      if (second >= 3) std::swap(other[0], other[1]);  // turns the other way
      std::rotate(other.begin(), other.begin() + second % 3, other.end());
      const std::vector<PackedTriangle> triangles{triangle_of(one, 5), triangle_of(other, 4)};
      EXPECT_EQ(decode_block(encode_block(triangles)->bits), triangles) << first << second;
    }
}

/// All leaves of the built-in scenes, at several sizes of leaves and grids: the decoded triangles are those of the
/// structure, every block is full to 128 bytes at most, and all blocks are used.
TEST(PackedLeaves, HoldTheTrianglesOfTheBuiltInScenes) {
  for (const auto& scene_name : kEnumNames<BuiltinScene>) {
    if (scene_name.value == BuiltinScene::kGaussians) continue;  // no surfaces
    for (const int bits : {6, 12, 16, 24})
      for (const std::int64_t leaf : {1, 4, 16}) {
        scene::Scene scene = small_builtin(scene_name.value, 3000, 20);
        scene::quantise(scene, bits);
        BvhConfig bvh;
        bvh.leaves = BvhConfig::Leaves::kBlocks;
        bvh.leaf_triangles = leaf;
        const Accel accel = build(scene, bvh, *make_sequential_executor());
        ASSERT_TRUE(accel.packed);
        std::uint64_t triangles = 0;
        const auto look = [&](NodeRef ref) {
          if (ref.is_inner() || ref.is_instance()) return;
          const PackedLeaves::Place& place = accel.packed->place(ref);
          std::vector<PackedTriangle> stored = triangles_of(accel, ref), decoded = accel.packed->decoded(ref);
          std::sort(stored.begin(), stored.end());
          std::sort(decoded.begin(), decoded.end());
          ASSERT_EQ(stored, decoded) << scene_name.name << " " << bits << " " << leaf;
          EXPECT_EQ(place.begin % kPackedBytes, 0u);
          EXPECT_EQ(place.bytes, place.blocks * kPackedBytes);
          triangles += ref.triangles();
        };
        for (const Node& node : accel.nodes)
          for (int lane = 0; lane < node.count; ++lane) look(node.child[lane]);
        const PackedLeafCounts& counts = accel.packed->counts();
        EXPECT_EQ(counts.bytes, counts.blocks * kPackedBytes);
        EXPECT_EQ(counts.blocks, accel.packed->blocks().size());
        // Measured: one block of foliage has no room for corners on the finest grid, and keeps floats.
        const bool finest = scene_name.value == BuiltinScene::kFoliage && bits == 24;
        EXPECT_LE(counts.raw_blocks, finest ? 1u : 0u) << scene_name.name << " " << bits;
        if (accel.root_key().ref.is_inner() && scene.meshes.size() == 1) {
          EXPECT_EQ(counts.triangles, triangles);
        }
      }
  }
}

/// The goal of blocks, on scenes of bench/studies/compressed_blocks. The smaller one of spheres has up to 8.3.
TEST(PackedLeaves, HaveEightBytesATriangle) {
  for (const auto& [which, triangles] :
       {std::pair{BuiltinScene::kTerrain, 20000}, std::pair{BuiltinScene::kSpheres, 80000}})
    for (const std::int64_t leaf : {4, 16}) {
      scene::Scene scene = small_builtin(which, triangles);
      scene::quantise(scene, 16);
      BvhConfig bvh;
      bvh.leaves = BvhConfig::Leaves::kBlocks;
      bvh.leaf_triangles = leaf;
      const PackedLeafCounts counts = build(scene, bvh, *make_sequential_executor()).packed->counts();
      EXPECT_LE(static_cast<double>(counts.bytes), 8.0 * static_cast<double>(counts.triangles)) << leaf;
    }
}

/// A leaf that no block has room for has several, in which the next leaf has no part.
TEST(PackedLeaves, GiveALargeLeafBlocksOfItsOwn) {
  std::mt19937 random(3);
  std::vector<Vec3> corners;
  for (int i = 0; i < 3 * 16; ++i) {
    const auto coordinate = [&] { return static_cast<float>(random() % (1u << 22)); };
    corners.push_back({coordinate(), coordinate(), coordinate()});
  }
  BvhConfig bvh;
  bvh.leaves = BvhConfig::Leaves::kBlocks;
  bvh.leaf_triangles = 16;
  const Accel accel = build(scene_of(soup(corners)), bvh, *make_sequential_executor());
  const PackedLeafCounts& counts = accel.packed->counts();
  EXPECT_EQ(counts.triangles, 16u);
  EXPECT_GT(counts.blocks, counts.leaves);
  std::uint32_t most = 0;
  const auto look = [&](NodeRef ref) {
    if (!ref.is_inner() && !ref.is_instance()) most = std::max(most, blocks_to_decode(accel, ref));
  };
  look(accel.root_key().ref);
  for (const Node& node : accel.nodes)
    for (int lane = 0; lane < node.count; ++lane) look(node.child[lane]);
  EXPECT_GT(most, 1u);
}

}  // namespace
}  // namespace carousel::accel

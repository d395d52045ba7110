// Trees from files: what is written is read back as it was, a tree that somebody else has built gives the same hits,
// and one that would lose hits is refused with the line.
#include "accel/builders/file/tree_file.h"

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "accel/builders/file/write_trees.h"
#include "accel/structure/primitive_boxes.h"
#include "core/system/error.h"
#include "tests/accel/structure/passing_scenes.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel::tree_file_test {
namespace {

using testing::HasSubstr;

class TreeFiles : public testing::Test {
 protected:
  ~TreeFiles() override { std::filesystem::remove(path_); }

  std::string written(const Accel& accel, const scene::Scene& scene) {
    AtomicFile file(path_);
    write_trees(file, accel, scene);
    file.commit();
    std::ostringstream text;
    text << std::ifstream(path_).rdbuf();
    return text.str();
  }
  static TreeFile trees(const std::string& text) {
    std::istringstream in(text);
    return read_trees(in, "t.trees");
  }
  static Accel built(const scene::Scene& scene, const std::string& text, const BvhConfig& config = {}) {
    const TreeFile file = trees(text);
    return build(scene, config, *make_sequential_executor(), {}, {}, nullptr, &file);
  }
  /// What is told of a file; empty if it is taken.
  static std::string fault(const scene::Scene& scene, const std::string& text, const BvhConfig& config = {}) {
    try {
      built(scene, text, config);
    } catch (const SceneError& error) {
      return error.file() + ": " + error.message();
    }
    return "";
  }

 private:
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                fmt::format("carousel_tree_file_{}.trees", reinterpret_cast<std::uintptr_t>(this));
};

void expect_same(const Accel& a, const Accel& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.blocks.size(), b.blocks.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    ASSERT_EQ(a.nodes[i].count, b.nodes[i].count);
    ASSERT_EQ(a.nodes[i].triangles, b.nodes[i].triangles);
    for (int lane = 0; lane < a.nodes[i].count; ++lane) {
      ASSERT_EQ(a.nodes[i].child[lane], b.nodes[i].child[lane]) << "node " << i;
      for (int plane = 0; plane < 6; ++plane)
        ASSERT_EQ(a.nodes[i].plane[plane][lane], b.nodes[i].plane[plane][lane]) << "node " << i;
    }
  }
  for (std::size_t i = 0; i < a.blocks.size(); ++i)
    for (int lane = 0; lane < kBlockTriangles; ++lane)
      ASSERT_EQ(a.blocks[i].primitive[lane], b.blocks[i].primitive[lane]) << "block " << i;
  EXPECT_EQ(a.max_depth, b.max_depth);
}

TEST_F(TreeFiles, AreReadAsTheyWereWritten) {
  const scene::Scene scenes[] = {small_builtin(BuiltinScene::kTerrain, 4000), small_builtin(BuiltinScene::kInstances),
                                 small_builtin(BuiltinScene::kSpheres), small_builtin(BuiltinScene::kCornell),
                                 passing_scene(BuiltinScene::kInstances, 6, 3)};
  for (const scene::Scene& scene : scenes)
    for (const BvhConfig::Merge merge : {BvhConfig::Merge::kNone, BvhConfig::Merge::kWorld}) {
      BvhConfig config;
      config.merge = merge;
      const Accel own = build(scene, config, *make_sequential_executor());
      expect_same(built(scene, written(own, scene), config), own);
    }
}

/// A tree over a mesh of `count` triangles as somebody else may build it: halves in the order of their numbers.
class Halves {
 public:
  Halves(const scene::Mesh& mesh, std::uint32_t number) : mesh_(mesh) {
    const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
    lines_.emplace_back();
    const Aabb box = add(0, 0, count);
    static_cast<void>(box);
    text_ = fmt::format("mesh {} {}  # by halves\n", number, count);
    for (std::size_t node = 0; node < lines_.size(); ++node) text_ += fmt::format("node {}\n{}", node, lines_[node]);
  }
  const std::string& text() const { return text_; }

 private:
  Aabb add(std::size_t node, std::uint32_t begin, std::uint32_t end) {
    Aabb whole;
    const std::uint32_t middle = begin + (end - begin) / 2;
    for (const auto& [from, to] : {std::pair{begin, middle}, {middle, end}}) {
      if (from == to) continue;
      Aabb box;
      std::string line;
      if (to - from <= 2) {
        for (std::uint32_t i = from; i < to; ++i) {
          for (std::uint32_t k = 0; k < 3; ++k) box.extend(mesh_.positions[mesh_.indices[3 * i + k]]);
          line += fmt::format(" {}", i);
        }
        lines_[node] += "leaf" + corners(box) + line + "\n";
      } else {
        const std::size_t below = lines_.size();
        lines_.emplace_back();
        box = add(below, from, to);
        lines_[node] += fmt::format("  inner {}{}\n", below, corners(box));
      }
      whole.extend(box);
    }
    return whole;
  }
  static std::string corners(const Aabb& box) {
    return fmt::format(" {} {} {} {} {} {}", box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z);
  }

  const scene::Mesh& mesh_;
  std::vector<std::string> lines_;
  std::string text_;
};

TEST_F(TreeFiles, OfOthersGiveTheSameHits) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 600);
  std::string text = "carousel_trees 1\n\n";
  for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) text += Halves(scene.meshes[mesh], mesh).text();
  const Accel accel = built(scene, text);
  const BruteForceAnswers answers(scene, mixed_rays(scene, static_cast<std::size_t>(scaled(4000, 500)), 5));
  EXPECT_GT(answers.hits(), 100u);
  EXPECT_EQ(answers.differences(accel), 0u);
  EXPECT_NE(accel.nodes.size(), build_sequential(scene).nodes.size());
}

/// Two triangles, and a tree over them that is right.
scene::Scene pair() {
  return scene_of(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {3, 0, 0}, {2, 1, 1}}));
}
const std::string kHead = "carousel_trees 1\nmesh 0 2\n";
const std::string kLeft = "leaf 0 0 0 1 1 0 0\n", kRight = "leaf 2 0 0 3 1 1 1\n";

TEST_F(TreeFiles, ThatWouldLoseHitsAreRefusedWithTheLine) {
  const scene::Scene scene = pair();
  const std::string deep = kHead + "node 0\n" + kLeft + "inner 1 2 0 0 3 1 1\nnode 1\n" + kRight;
  EXPECT_EQ(fault(scene, kHead + "node 0\n" + kLeft + kRight), "");
  EXPECT_EQ(fault(scene, deep), "");
  const std::pair<std::string, std::string> faults[] = {
      {kHead + "node 0\nleaf 0 0 0 1 0.99999 0 0\n" + kRight,
       "t.trees:4: the box of a leaf of node 0 does not hold its primitive 0"},
      {kHead + "node 0\n" + kLeft + "inner 1 2 0 0 3 1 0.9\nnode 1\n" + kRight,
       "t.trees:5: the box of node 1 does not hold that of its child in line 7"},
      {kHead + "node 0\n" + kLeft,
       "t.trees:2: expected each of the 2 primitives of mesh 0 in a leaf, found primitive 1"},
      {kHead + "node 0\n" + kLeft + "leaf 0 0 0 3 1 1 0 1\n",
       "t.trees:5: expected each primitive in one leaf, found primitive 0"},
      {kHead + "node 0\n" + kLeft + "leaf 0 0 0 3 1 1 2\n", "t.trees:5: expected one of the 2 primitives of mesh 0"},
      {kHead + "node 0\n" + kLeft + "inner 2 2 0 0 3 1 1\nnode 1\n" + kRight,
       "t.trees:5: expected one of the 2 nodes of mesh 0, found node 2"},
      {kHead + "node 0\n" + kLeft + kRight + "node 1\ninner 1 0 0 0 3 1 1\n",
       "t.trees:7: expected a node behind node 1, its parent, found node 1"},
      {kHead + "node 0\n" + kLeft + kRight + "node 1\n" + kRight, "t.trees:7: expected each primitive in one leaf"},
      {kHead + "node 0\n" + kLeft + "inner 1 2 0 0 3 1 1\ninner 1 2 0 0 3 1 1\nnode 1\n" + kRight,
       "t.trees:6: expected one parent of each node, found a second of node 1"},
      {"carousel_trees 1\nmesh 0 3\nnode 0\n" + kLeft + kRight, "t.trees:2: expected mesh 0 with 2 primitives"},
      {"carousel_trees 1\nmesh 1 2\nnode 0\n" + kLeft + kRight, "t.trees: has no tree of mesh 0"},
  };
  for (const auto& [text, told] : faults) EXPECT_THAT(fault(scene, text), HasSubstr(told)) << text;
  BvhConfig narrow;
  narrow.width = 2;
  EXPECT_THAT(fault(scene, kHead + "node 0\nleaf 0 0 0 3 1 1 0\nleaf 0 0 0 3 1 1 1\nleaf 0 0 0 3 1 1 1\n", narrow),
              HasSubstr("t.trees:3: expected at most 2 children of a node (bvh.width), found 3 of node 0"));
  BvhConfig small;
  small.leaf_triangles = 1;
  EXPECT_THAT(fault(scene, kHead + "node 0\nleaf 0 0 0 3 1 1 0 1\n", small),
              HasSubstr("t.trees:4: expected at most 1 primitives in a leaf (bvh.leaf_triangles), found 2"));
}

TEST_F(TreeFiles, HaveNodesThatAreNamedAndNotTooDeep) {
  const scene::Scene scene = pair();
  EXPECT_THAT(fault(scene, kHead + "node 0\n" + kLeft + kRight +
                               "node 1\ninner 2 0 0 0 3 1 1\nnode 2\ninner 3 0 0 0 3 1 "
                               "1\nnode 3\ninner 4 0 0 0 3 1 1\n"),
              HasSubstr("expected one of the 4 nodes"));
  std::string chain = kHead;
  for (int node = 0; node < 80; ++node) chain += fmt::format("node {}\ninner {} 0 0 0 3 1 1\n", node, node + 1);
  chain += "node 80\n" + kLeft + kRight;
  EXPECT_THAT(fault(scene, chain), HasSubstr("expected at most 72 nodes on a way down"));
}

TEST_F(TreeFiles, AreTextWhoseWordsAreChecked) {
  const std::pair<std::string, std::string> faults[] = {
      {"", "t.trees:1: expected the first line 'carousel_trees 1'"},
      {"carousel_trees 2\n", "t.trees:1: expected the first line 'carousel_trees 1', found 'carousel_trees 2'"},
      {"carousel_trees 1\n", "has no tree"},
      {"carousel_trees 1\nnode 0\n", "t.trees:2: expected 'mesh NUMBER PRIMITIVES' before its nodes"},
      {kHead + "nod 0\n",
       "t.trees:3: expected mesh, instance, merged, node, inner or leaf, found 'nod'; did you mean 'node'?"},
      {kHead + "node 1\n", "t.trees:3: expected node 0"},
      {kHead + "node 0\n", "t.trees:3: node 0 has no children"},
      {kHead, "t.trees:2: mesh 0 has no nodes"},
      {kHead + "node 0\nleaf 0 0 0 1 1 x 0\n", "t.trees:4: expected a coordinate of the box, found 'x'"},
      {kHead + "node 0\nleaf 0 0 0 1 1 nan 0\n", "t.trees:4: expected a box of six finite numbers"},
      {kHead + "node 0\nleaf 1 0 0 0 1 1 0\n", "t.trees:4: expected a box of six finite numbers"},
      {kHead + "node 0\nleaf 0 0 0 1 1 1\n", "t.trees:4: expected the numbers of a leaf's primitives"},
      {kHead + "node 0\nleaf 0 0 0 1 1 1 -1\n", "t.trees:4: expected the number of a primitive, found '-1'"},
      {kHead + "node 0\ninner 4294967295 0 0 0 1 1 1\n", "t.trees:4: expected a node below"},
      {kHead + "node 0\ninner 1 0 0 0 1 1 1 7\n", "t.trees:4: expected the end of the line, found '7'"},
      {kHead + "node 0\n" + kLeft + kRight + "mesh 0 2\n", "t.trees:6: expected one tree of mesh 0, found a second"},
  };
  for (const auto& [text, told] : faults) EXPECT_THAT(fault(pair(), text), HasSubstr(told)) << text;
}

TEST_F(TreeFiles, OfCutTrianglesAreNotWritten) {
  BvhConfig config;
  config.builder = BvhConfig::Builder::kKd;
  config.duplicates = 2;
  const scene::Scene scene = small_builtin(BuiltinScene::kSpheres);
  const Accel accel = build(scene, config, *make_sequential_executor());
  EXPECT_THROW(written(accel, scene), ConfigError);
}

}  // namespace
}  // namespace carousel::accel::tree_file_test

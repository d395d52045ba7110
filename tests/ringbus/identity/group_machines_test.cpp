// Instances of instances: machines with structures of two to eight levels have the digest of the two-level reference,
// on a nested built-in scene and on a file whose nodes are groups of groups.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "core/config/load/load.h"
#include "ringbus/cycle/shapes/shape_memory.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/ringbus/support/test_machine.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::ringbus {
namespace {

using Json = nlohmann::json;

/// Nodes six groups deep, two children each, turned about the vertical, shrunk and moved apart; at the bottom meshes.
int nested_node(scene::GltfBuilder& b, int depth, int which) {
  const double angle = 0.4 + 0.3 * which, sign = which == 0 ? -1 : 1;
  Json node = {{"rotation", {0, std::sin(angle), 0, std::cos(angle)}},
               {"scale", {0.8, which == 0 ? 0.8 : 0.7, 0.8}},
               {"translation", {1.3 * sign, 0.5 * which, 0.4 * sign}}};
  if (depth == 0)
    node["mesh"] = 0;
  else
    node["children"] = {nested_node(b, depth - 1, 0), nested_node(b, depth - 1, 1)};
  return b.push("nodes", node);
}

scene::Scene nested_file() {
  const scene::Mesh ball = accel::icosphere_scene(1, Vec3{0}, 0.6f).meshes.front();
  std::vector<float> positions;
  for (const Vec3& p : ball.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
  scene::GltfBuilder b;
  const int points = b.floats(positions, "VEC3", 3);
  const int indices = b.accessor(b.view(ball.indices), 5125, ball.indices.size(), "SCALAR");
  b.mesh({{"POSITION", points}}, indices);
  b.json["nodes"] = Json::array();
  b.json["scenes"][0]["nodes"] = Json::array();
  const int first = nested_node(b, 6, 0), second = nested_node(b, 6, 1);
  b.json["scenes"][0]["nodes"] = {first, second};
  return b.load();
}

Cell levels_cell(const std::string& machine, std::int64_t levels, TransformLevel transform) {
  const std::vector<std::string> sets{fmt::format("bvh.levels={}", levels), "bvh.width=4",
                                      fmt::format("accuracy.transform={}", enum_name(transform))};
  Cell cell;
  cell.config = load_config({"scene: {builtin: cornell}\n" + machine, "levels.yaml"}, sets).config;
  return cell;
}

constexpr const char* kNative = "engine: {kind: native, threads: 1}\ntopology: {resources: 3}\n";
constexpr const char* kTreelets =
    "engine: {kind: native, threads: 2}\ntopology: {resources: 3}\ncollections: {traversal: treelet}\n"
    "bvh: {treelet_triangles: 300}\n";
constexpr const char* kCycle = "engine: {kind: cycle}\ntopology: {resources: 3}\n";
constexpr const char* kCycleTreelets =
    "engine: {kind: cycle}\ntopology: {resources: 3}\ncollections: {traversal: treelet}\n";
constexpr const char* kCycleOrdered =
    "engine: {kind: cycle}\ntopology: {resources: 2}\ncollections: {traversal: ordered}\n";
constexpr const char* kIndependent = "engine: {kind: cycle}\ntopology: {resources: 2, shape: independent}\n";

void expect_one_digest_of(TestScene& scene, std::int64_t deepest) {
  for (const char* const machine : {kNative, kTreelets, kCycle, kCycleTreelets, kCycleOrdered, kIndependent})
    for (const std::int64_t levels : {2, 3, 4, 8})
      for (const auto& transform : kEnumNames<TransformLevel>) {
        const Cell cell = levels_cell(machine, levels, transform.value);
        const Outcome outcome = run_cell(scene, cell);
        EXPECT_EQ(outcome.fault, "") << cell.text();
        const accel::Accel& accel = scene.accel(cell.config.bvh, {}, cell.config.accuracy);
        EXPECT_EQ(accel.groups.empty(), levels == 2);
        if (levels == 8) {
          EXPECT_GE(accel.groups.size(), static_cast<std::size_t>(deepest));
        }
      }
}

TEST(GroupMachines, ChangeNoDigestOnTheNestedScene) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300, 6), 800, 2);
  expect_one_digest_of(scene, 4);
}

TEST(GroupMachines, ChangeNoDigestOnANestedFile) {
  const scene::Scene file = nested_file();
  EXPECT_EQ(file.instances.size(), 128u);
  EXPECT_EQ(file.groups.size(), 6u);  // one for each depth
  EXPECT_EQ(file.placements.size(), 126u);
  TestScene scene(file, 800, 2);
  expect_one_digest_of(scene, 126);
}

// Each placement on a ray's way is transformed to and read as an instance is.
TEST(GroupMachines, AreCountedAndCharged) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 1000, 6), 800, 2);
  const auto run = [&](std::int64_t levels) {
    Outcome outcome = run_cell(scene, levels_cell(kCycle, levels, TransformLevel::kTwoStep));
    EXPECT_EQ(outcome.fault, "");
    return outcome;
  };
  const Outcome flat = run(2), three = run(3), six = run(6);
  EXPECT_GT(three.sum.tests.transforms, flat.sum.tests.transforms);
  EXPECT_GT(six.sum.tests.transforms, three.sum.tests.transforms);
}

// 48 bytes of a transform; of members the world box and a number, of groups a slack besides.
TEST(GroupMachines, HaveRecordsOfMembersOneBehindTheOther) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 300, 5), 1, 0);
  BvhConfig bvh;
  bvh.levels = 5;
  const accel::Accel& accel = scene.accel(bvh);
  const cycle::ShapeMemory memory(accel, {}, bvh);
  const std::size_t own = accel.instances.size() - accel.groups.size();
  std::set<std::uint64_t> addresses;
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i) {
    const accel::InstanceNode& node = accel.instances[i];
    const cycle::ShapeSpan record = memory.transform(i);
    EXPECT_EQ(record.bytes,
              (node.transform.identity ? 0u : 48u) + (node.group || node.member ? 28u : 0u) + (node.group ? 16u : 0u));
    if (record.bytes > 0) {
      EXPECT_TRUE(addresses.insert(record.address).second);
    }
    EXPECT_EQ(node.group, i >= own);
    if (!node.group) continue;
    const std::uint32_t first = accel.group(i).first_member;
    const accel::NodeKey key{i, node.root};
    for (std::uint32_t m = 0; m < 4; ++m)  // as many as the fourth root of 300
      EXPECT_EQ(memory.transform(accel.members[first + m]).address,
                memory.transform(accel.members[first]).address + 128 * m);
    EXPECT_FALSE(memory.reads_record(key) && !node.member);
  }
}

}  // namespace
}  // namespace carousel::ringbus

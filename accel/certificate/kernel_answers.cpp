#include "accel/certificate/kernel_answers.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

std::array<BoxAnswer, kMaxWidth> box_answers(BoxLevel level, const Ray& ray, std::span<const Aabb> boxes) {
  Accel accel;
  accel.accuracy.box = level;
  Node& node = accel.nodes.emplace_back();
  node.count = static_cast<std::uint8_t>(boxes.size());
  for (std::size_t lane = 0; lane < boxes.size(); ++lane) {
    for (int axis = 0; axis < 3; ++axis) {
      node.plane[axis][lane] = boxes[lane].lo[axis];
      node.plane[axis + 3][lane] = boxes[lane].hi[axis];
    }
  }
  RayRecord record;
  start_record({ray, {}}, record);
  std::uint8_t mask = 0;
  float nearest[kMaxWidth], entries[kMaxWidth] = {};
  std::fill(nearest, nearest + kMaxWidth, kInfinity);
  IntersectionCounts counts;
  test_strip(accel, {kNoInstance, NodeRef::inner(0)}, ~0u, {&record, nullptr, 1}, {&mask, nearest, entries}, counts);
  std::array<BoxAnswer, kMaxWidth> out;
  for (std::size_t lane = 0; lane < boxes.size(); ++lane) out[lane] = {(mask >> lane & 1) != 0, entries[lane]};
  return out;
}

OneLeaf::OneLeaf(std::span<const Corners> triangles) {
  accel_.instances.resize(1);  // placed where it is
  accel_.root = {0, NodeRef::leaf(0, static_cast<std::uint32_t>(triangles.size()))};
  accel_.blocks.resize(accel_.root.ref.blocks());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    TriangleBlock& block = accel_.blocks[i / kBlockTriangles];
    const std::uint32_t lane = i % kBlockTriangles;
    block.primitive[lane] = i;
    for (std::size_t k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) block.vertex[k][axis][lane] = triangles[i][k][axis];
      model_.extend(triangles[i][k]);
    }
  }
}

bool OneLeaf::place(const scene::Affine& world_from_model, TransformLevel level) {
  InstanceNode& node = accel_.instances[0];
  node.root = accel_.root.ref;
  node.world = world_box(world_from_model, model_, level);
  return make_transform(world_from_model, node.transform, level);
}

Hit OneLeaf::hit(const Ray& ray, const AccuracyConfig& accuracy) {
  accel_.accuracy = accuracy;
  RayRecord record;
  start_record({ray, {}}, record);
  IntersectionCounts counts;
  test_strip(accel_, accel_.root, ~0u, {&record, nullptr, 1}, {}, counts);
  return record.hit.valid() ? record.hit : Hit{};
}

std::string text(float x) {
  return fmt::format("{:a} ({:.9g})", x, x);
}
std::string text(const Vec3& v) {
  return fmt::format("({:a}, {:a}, {:a}) ({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z, v.x, v.y, v.z);
}

std::string text(const Hit& hit) {
  if (!hit.valid()) return "missed";
  return fmt::format("hit triangle {} at t = {}, u = {}, v = {}", hit.primitive, text(hit.t), text(hit.u), text(hit.v));
}

}  // namespace carousel::accel

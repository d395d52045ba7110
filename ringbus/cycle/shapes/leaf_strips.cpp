#include "ringbus/cycle/shapes/leaf_strips.h"

#include <bit>

#include "ringbus/cycle/shapes/triangle_strips.h"

namespace carousel::ringbus::cycle {

namespace {

constexpr std::uint32_t kVertexBytes = 12, kReferenceBytes = 4;
constexpr std::uint32_t kPrimitiveBytes = sizeof(accel::TriangleBlock) / accel::kBlockTriangles;

std::vector<StripTriangle> strip_triangles(const accel::Accel& accel, accel::NodeRef leaf) {
  std::vector<StripTriangle> out;
  for (std::uint32_t i = 0; i < leaf.triangles(); ++i) {
    const accel::TriangleBlock& block = accel.blocks[leaf.first_block() + i / accel::kBlockTriangles];
    StripTriangle& triangle = out.emplace_back();
    for (std::size_t vertex = 0; vertex < 3; ++vertex)
      for (std::size_t axis = 0; axis < 3; ++axis)
        triangle[vertex][axis] = std::bit_cast<std::uint32_t>(block.vertex[vertex][axis][i % accel::kBlockTriangles]);
  }
  return out;
}

}  // namespace

LeafStrips::LeafStrips(const accel::Accel& accel) : begin_(accel.blocks.size()), bytes_(accel.blocks.size()) {
  for (const accel::Node& node : accel.nodes)
    for (int lane = 0; lane < node.count; ++lane)
      if ((node.direct >> lane & 1) == 0) add(accel, node.child[lane]);
  for (const accel::InstanceNode& instance : accel.instances) add(accel, instance.root);
  add(accel, accel.root_key().ref);
}

void LeafStrips::add(const accel::Accel& accel, accel::NodeRef leaf) {
  if (leaf.is_inner() || leaf.is_instance() || leaf.triangles() == 0 || bytes_[leaf.first_block()] > 0) return;
  const std::uint32_t triangles = leaf.triangles();
  std::uint32_t bytes = triangles * kPrimitiveBytes;
  const std::uint32_t separate = bytes;
  if (!leaf.is_procedural()) {
    const StripCounts counts = triangle_strips(strip_triangles(accel, leaf));
    bytes = counts.vertices * kVertexBytes + triangles * kReferenceBytes;
    counts_.triangles += triangles;
    counts_.strips += counts.strips;
    counts_.vertices += counts.vertices;
  }
  begin_[leaf.first_block()] = counts_.bytes;
  bytes_[leaf.first_block()] = bytes;
  counts_.bytes += bytes;
  counts_.separate_bytes += separate;
}

}  // namespace carousel::ringbus::cycle

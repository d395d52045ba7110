#include "accel/box/bundle_primitives.h"

#include "accel/box/bundle_interval.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

Aabb box_of_primitive(const TriangleBlock& block, std::uint32_t lane, bool procedural) {
  if (procedural) return procedural_box(block, lane);
  Aabb box;
  for (const auto& vertex : block.vertex) box.extend(Vec3{vertex[0][lane], vertex[1][lane], vertex[2][lane]});
  return box;
}

template <class Real>
std::uint32_t in_reach(const Accel& accel, NodeRef leaf, const BundleRecord& bundle) {
  const BundleInterval<Real> interval(bundle, far_widening(accel.accuracy.box));
  std::uint32_t out = 0;
  for (std::uint32_t i = 0; i < leaf.triangles(); ++i) {
    const TriangleBlock& block = accel.blocks[leaf.first_block() + i / kBlockTriangles];
    const Aabb box = box_of_primitive(block, i % kBlockTriangles, leaf.is_procedural());
    if (!interval.all_miss(accel::planes_of<Real>(box))) out |= 1u << i;
  }
  return out;
}

}  // namespace

std::uint32_t primitives_in_reach(const Accel& accel, NodeRef leaf, const BundleRecord& bundle) {
  const bool in_double = accel.accuracy.box == BoxLevel::kDouble;
  return (in_double ? in_reach<double> : in_reach<float>)(accel, leaf, bundle);
}

}  // namespace carousel::accel

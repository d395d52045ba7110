// Depth-first traversal with a stack, nearest child first: the reference tracer, and what a treelet's visit does.
#if defined(CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#undef CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#else
#define CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/accel.h"
#include "accel/kernels.h"
#include "accel/slab-inl.h"
#include "accel/watertight-inl.h"
#include "core/test_counts.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// A traversal stack. Its depth bound: binary depth is at most 72 (accel/sah_build.cpp), a level leaves at
/// most seven siblings behind.
struct DepthFirstStack {
  struct Entry {
    float entry;
    NodeRef ref;
  };
  static constexpr int kCapacity = 512;
  Entry entries[kCapacity];
};

/// Everything testing below one instance (or in the world) needs of a ray.
struct FrameRay {
  SlabRay slab;
  WatertightRay watertight;
  std::uint32_t instance;
  float instance_entry;

  FrameRay(const Ray& ray, std::uint32_t i, float entry)
      : slab(ray), watertight(ray), instance(i), instance_entry(entry) {}
};

/// The ray below instance `index`: in model space, with the entry into the instance's world box.
HWY_INLINE FrameRay enter_instance(const InstanceNode& node, std::uint32_t index, const Ray& world,
                                   const SlabRay& world_slab, TestCounts& counts) {
  float entry;
  // The box has been hit on the way here; only the entry is wanted.
  slab(world_slab, node.world, kInfinity, entry);
  if (!node.transform.identity) ++counts.transforms;
  return FrameRay(node.transform.to_model(world), index, entry);
}

HWY_INLINE bool test_leaf(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const FrameRay& ray, Hit& hit) {
  bool changed = false;
  for (std::uint32_t b = 0; b < leaf.blocks(); ++b, lanes >>= kBlockTriangles)
    changed |= watertight_block(accel.blocks[leaf.first_block() + b], ray.watertight, ray.slab, lanes,
                                ray.instance_entry, ray.instance, hit);
  return changed;
}

/// Visits everything below `root`. `visit_other(ref)` tests what is not an inner node and returns true to stop.
template <class VisitOther>
HWY_INLINE bool depth_first(const Accel& accel, NodeRef root, const SlabRay& ray, const Hit& hit,
                            DepthFirstStack& stack, TestCounts& counts, const VisitOther& visit_other) {
  int top = 0;
  NodeRef ref = root;
  for (;;) {
    while (ref.is_inner()) {
      const Node& node = accel.nodes[ref.node()];
      alignas(64) float entry[kMaxWidth];
      counts.box += node.count;
      std::uint32_t mask = slab_node(node, ray, hit.t, entry);
      if (mask == 0) goto pop;
      const int first = std::countr_zero(mask);
      mask &= mask - 1;
      DepthFirstStack::Entry nearest{entry[first], node.child[first]};
      if (HWY_LIKELY(mask == 0)) {
        ref = nearest.ref;
        continue;
      }
      const int bottom = top;
      for (; mask != 0; mask &= mask - 1) {
        const int lane = std::countr_zero(mask);
        DepthFirstStack::Entry other{entry[lane], node.child[lane]};
        if (other.entry < nearest.entry) std::swap(other, nearest);
        int at = top++;
        for (; at > bottom && stack.entries[at - 1].entry < other.entry; --at)
          stack.entries[at] = stack.entries[at - 1];
        stack.entries[at] = other;
      }
      ref = nearest.ref;
    }
    if (visit_other(ref)) return true;
  pop:
    do {
      if (top == 0) return false;
      --top;
    } while (stack.entries[top].entry > hit.t);
    ref = stack.entries[top].ref;
  }
}

HWY_INLINE int leaf_triangles(const Accel& accel, NodeRef leaf) {
  int triangles = 0;
  for (std::uint32_t b = 0; b < leaf.blocks(); ++b)
    for (int l = 0; l < kBlockTriangles; ++l)
      triangles += accel.blocks[leaf.first_block() + b].primitive[l] != kNoPrimitive;
  return triangles;
}

/// Below one instance. True when a shadow ray is settled.
HWY_INLINE bool trace_instance(const Accel& accel, NodeRef root, const FrameRay& ray, bool any_hit, Hit& hit,
                               DepthFirstStack& stack, TestCounts& counts) {
  return depth_first(accel, root, ray.slab, hit, stack, counts, [&](NodeRef leaf) {
    counts.triangle += static_cast<std::uint64_t>(leaf_triangles(accel, leaf));
    return test_leaf(accel, leaf, ~0u, ray, hit) && any_hit;
  });
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

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
    std::uint32_t ref;   // bits of a NodeRef, which would be initialised: 512 times a call for nothing
  };
  static constexpr int kCapacity = 512;
  Entry entries[kCapacity];
};

/// Everything testing below one instance needs of a ray. Refers to the slab form, which outlives it: copying
/// what was just written piece by piece would stall on the stores.
struct FrameRay {
  const SlabRay& slab;
  WatertightRay watertight;
  std::uint32_t instance;
  float instance_entry;

  FrameRay(const SlabRay& s, const Ray& ray, std::uint32_t i, float entry)
      : slab(s), watertight(ray), instance(i), instance_entry(entry) {}
};

/// Calls `body(frame)` with the ray as it is below instance `index`: in model space.
template <class Body>
HWY_INLINE bool in_instance(const InstanceNode& node, std::uint32_t index, const Ray& world, const SlabRay& world_slab,
                            float entry, TestCounts& counts, const Body& body) {
  if (node.transform.identity) return body(FrameRay(world_slab, world, index, entry));
  ++counts.transforms;
  const Ray model = node.transform.to_model(world);
  const SlabRay model_slab(model);
  return body(FrameRay(model_slab, model, index, entry));
}

/// Entry into the world box of an instance, which has been hit on the way here.
HWY_INLINE float instance_entry(const InstanceNode& node, const SlabRay& world) {
  float entry;
  slab(world, node.world, kInfinity, entry);
  return entry;
}

HWY_INLINE bool test_leaf(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const FrameRay& ray, Hit& hit) {
  bool changed = false;
  for (std::uint32_t b = 0; b < leaf.blocks(); ++b, lanes >>= kBlockTriangles)
    changed |= watertight_block(accel.blocks[leaf.first_block() + b], ray.watertight, ray.slab, lanes,
                                ray.instance_entry, ray.instance, hit);
  return changed;
}

/// A node that waits on the stack is on its way from memory while the nearer ones are visited.
HWY_INLINE void prefetch(const Node* nodes, NodeRef ref) {
  if (!ref.is_inner()) return;
  const char* const bytes = reinterpret_cast<const char*>(nodes + ref.node());
  for (std::size_t line = 0; line < sizeof(Node); line += 64) __builtin_prefetch(bytes + line);
}

/// Visits everything below `root`. `visit_other(ref)` tests what is not an inner node and returns true to stop.
/// Adds the boxes tested to `boxes`.
template <class VisitOther>
HWY_INLINE bool depth_first(const Accel& accel, NodeRef root, const SlabRay& slab_ray, const Hit& hit,
                            DepthFirstStack& stack, std::uint64_t& boxes, const VisitOther& visit_other) {
  const SlabLanes ray(slab_ray);
  const Node* const nodes = accel.nodes.data();
  DepthFirstStack::Entry* top = stack.entries;
  NodeRef ref = root;
  std::uint64_t tested = 0;
  for (;;) {
    while (ref.is_inner()) {
      const Node& node = nodes[ref.node()];
      alignas(64) float entry[kMaxWidth];
      tested += node.count;
      std::uint32_t mask = slab_node(node, ray, hit.t, entry);
      if (mask == 0) goto pop;
      const int first = std::countr_zero(mask);
      mask &= mask - 1;
      if (mask == 0) {
        ref = node.child[first];
        continue;
      }
      const int second = std::countr_zero(mask);
      mask &= mask - 1;
      // Which of the two is nearer is a coin toss no predictor guesses: selected without a branch.
      const bool swap = entry[second] < entry[first];
      const int near_lane = swap ? second : first, far_lane = swap ? first : second;
      DepthFirstStack::Entry nearest{entry[near_lane], node.child[near_lane].bits()};
      DepthFirstStack::Entry* const bottom = top;
      *top++ = {entry[far_lane], node.child[far_lane].bits()};
      prefetch(nodes, node.child[far_lane]);
      for (; mask != 0; mask &= mask - 1) {
        const int lane = std::countr_zero(mask);
        DepthFirstStack::Entry other{entry[lane], node.child[lane].bits()};
        if (other.entry < nearest.entry) std::swap(other, nearest);
        DepthFirstStack::Entry* at = top++;
        for (; at > bottom && at[-1].entry < other.entry; --at) *at = at[-1];
        *at = other;
      }
      ref = NodeRef::from_bits(nearest.ref);
    }
    if (visit_other(ref)) {
      boxes += tested;
      return true;
    }
  pop:
    do {
      if (top == stack.entries) {
        boxes += tested;
        return false;
      }
      --top;
    } while (top->entry > hit.t);
    ref = NodeRef::from_bits(top->ref);
  }
}

/// Below one instance. True when a shadow ray is settled.
HWY_NOINLINE bool trace_instance(const Accel& accel, NodeRef root, const FrameRay& ray, bool any_hit, Hit& hit,
                               DepthFirstStack& stack, TestCounts& counts) {
  return depth_first(accel, root, ray.slab, hit, stack, counts.box, [&](NodeRef leaf) HWY_ATTR {
    counts.triangle += leaf.triangles();
    return test_leaf(accel, leaf, ~0u, ray, hit) && any_hit;
  });
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// Depth-first traversal of several rays in turn. One ray alone is a chain of waits: for a node's boxes, for the
// comparisons on them, for the node they lead to. Here the boxes of all rays are tested before any ray moves on, and
// nodes are on their way while it is the others' turn.
#if defined(CAROUSEL_ACCEL_INTERLEAVED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#undef CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#else
#define CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/traverse/depth_first-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// A ray on its way.
template <class Slab>
struct Walker {
  RayRecord* record;
  FrameStorage<Slab> frame;
  bool any_hit;
  NodeRef ref;         ///< the inner node to be visited next
  std::uint32_t mask;  ///< which of its children are hit
  DepthFirstStack::Entry* top;
  alignas(64) float entry[kMaxWidth];
  DepthFirstStack stack;
};

/// Takes a walker on from `ref`, or when it hit no child from its stack, to its next inner node; false when its ray is
/// done.
template <class Slab>
HWY_INLINE bool walk_on(const Accel& accel, Walker<Slab>& walker, bool any, NodeRef ref, TraceStacks& stacks,
                        TraversalCounts& counts) {
  LocalRay<Slab>& frame = walker.frame.ray;
  Hit& hit = walker.record->hit;
  for (;; any = false) {
    if (!any) {
      do {
        if (walker.top == walker.stack.entries) return false;
        --walker.top;
      } while (walker.top->entry > hit.t);
      ref = NodeRef::from_bits(walker.top->ref);
    }
    if (HWY_UNLIKELY(ref.is_instance()) && !enter_instance(accel, ref, frame)) {
      if (trace_instance<Slab>(accel, ref.instance_index(), *walker.record, stacks, counts)) return false;
      continue;
    }
    if (ref.is_inner()) {
      walker.ref = ref;
      prefetch_lines(accel.nodes.data() + ref.node());
      return true;
    }
    count_leaf(ref, counts);
    if (test_leaf(accel, ref, ~0u, frame, hit) && walker.any_hit) return false;
  }
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

// Depth-first traversal of several rays in turn. One ray alone is a chain of waits: for a node's boxes, for the
// comparisons on them, for the node they lead to. Here the boxes of all rays are tested before any ray moves on, and
// nodes and leaves are on their way while it is the others' turn.
#if defined(CAROUSEL_ACCEL_INTERLEAVED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#undef CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#else
#define CAROUSEL_ACCEL_INTERLEAVED_INL_H_
#endif

#include <cstddef>
#include <memory>
#include <utility>

#include <hwy/highway.h>

#include "accel/traverse/depth_first-inl.h"
#include "accel/traverse/members-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// Rays under way at a time: with sixteen a round may end before a line has come from memory.
inline constexpr std::size_t kWalkersInTurn = 24;

/// A ray on its way.
template <class Slab>
struct Walker {
  RayRecord* record;
  LocalRay<Slab>* frame;
  std::uint32_t ray;  ///< its number, for who sent it out
  bool any_hit;
  NodeRef ref;         ///< the inner node or the leaf to be visited next
  std::uint32_t mask;  ///< which of its children are hit
  DepthFirstStack::Entry* top;
  alignas(64) float entry[kMaxWidth];
  DepthFirstStack stack;
};

/// Takes a walker on from `ref`, or when it hit no child from its stack, to its next inner node, or to `ref` if
/// that is a leaf; false when its ray is done. Leaves from the stack are tested on the way: most have been fetched.
template <Nodes kNodes, class Slab>
HWY_INLINE bool walk_on(const Accel& accel, Walker<Slab>& walker, bool any, NodeRef ref, TraceStacks& stacks,
                        TraversalCounts& counts) {
  LocalRay<Slab>& frame = *walker.frame;
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
      if (trace_instance<kNodes, Slab>(accel, ref.instance_index(), *walker.record, stacks, counts)) return false;
      continue;
    }
    if (ref.is_inner()) {
      walker.ref = ref;
      prefetch_lines(accel.nodes.data() + ref.node());
      return true;
    }
    if (any) {
      walker.ref = ref;
      prefetch_block(accel, ref);
      return true;
    }
    count_leaf(ref, counts);
    if (test_leaf(accel, ref, ~0u, frame, hit) && walker.any_hit) return false;
  }
}

/// The walkers of a thread, some 200 KB. take_turns() has them while it runs, and nothing that it calls may trace rays
/// by it again.
template <class Slab>
Walker<Slab>* walkers_of_thread() {
  static thread_local const std::unique_ptr<Walker<Slab>[]> walkers(new Walker<Slab>[kWalkersInTurn]);
  return walkers.get();
}

/// Takes rays through the tree in turn. `start(walker)` gives a walker its next ray, its frame and any_hit, and returns
/// the node from which it goes, or nothing when no ray is left; `finish(walker)` is told of each that is done.
template <Nodes kNodes, class Slab, class Start, class Finish>
HWY_INLINE void take_turns(const Accel& accel, TraceStacks& stacks, TraversalCounts& counts, const Start& start,
                           const Finish& finish) {
  const Node* const nodes = accel.nodes.data();
  std::size_t count = 0;
  Walker<Slab>* const walkers = walkers_of_thread<Slab>();
  Walker<Slab>* active[kWalkersInTurn];
  const bool quantised = kNodes == Nodes::kOther && !accel.full_nodes.empty();
  const auto set_off = [&](Walker<Slab>& walker, std::size_t place) HWY_ATTR {
    NodeRef from;
    while (start(walker, place, from)) {
      walker.top = walker.stack.entries;
      if (walk_on<kNodes>(accel, walker, true, from, stacks, counts)) return true;
      finish(walker);
    }
    return false;
  };
  for (; count < kWalkersInTurn && set_off(walkers[count], count); ++count) active[count] = &walkers[count];
  while (count > 0) {
    for (std::size_t k = 0; k < count; ++k) {
      Walker<Slab>& walker = *active[k];
      if (!walker.ref.is_inner()) {
        walker.mask = 0;
        count_leaf(walker.ref, counts);
        if (test_leaf(accel, walker.ref, ~0u, *walker.frame, walker.record->hit) && walker.any_hit)
          walker.top = walker.stack.entries;
        continue;
      }
      const Node& node = nodes[walker.ref.node()];
      LocalRay<Slab>& frame = *walker.frame;
      walker.mask = met_children<kNodes>(accel, walker.ref, frame, in_registers(frame.slab), walker.record->hit.t,
                                         walker.entry, counts.box);
      if constexpr (kNodes == Nodes::kOther)
        walker.mask = cull(accel, node, frame.slab, frame.direction, ~0u, walker.mask, counts, counts.culls);
      if (HWY_UNLIKELY(quantised) && walker.mask != 0)
        count_extra_hits(accel, walker.ref, in_registers(frame.slab), walker.record->hit.t, walker.mask, counts);
      if (HWY_UNLIKELY(node.direct != 0) && test_direct(accel, node, ~0u, frame, walker.record->hit, counts) &&
          walker.any_hit) {
        walker.mask = 0;
        walker.top = walker.stack.entries;
      }
    }
    for (std::size_t k = 0; k < count;) {
      Walker<Slab>& walker = *active[k];
      const bool any = walker.mask != 0;
      NodeRef ref;
      if (any) ref = nearest_child(accel, nodes[walker.ref.node()], walker.mask, walker.entry, walker.top);
      if (!walk_on<kNodes>(accel, walker, any, ref, stacks, counts)) {
        finish(walker);
        if (!set_off(walker, static_cast<std::size_t>(&walker - walkers))) {
          std::swap(active[k], active[--count]);
          continue;
        }
      }
      ++k;
    }
  }
}

/// Traces the members, each through everything below `key`.
template <Nodes kNodes, class Slab>
void trace_in_turn(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  TraceStacks stacks;
  TraversalCounts counts(members.culls);
  std::size_t next = 0;
  FrameStorage<Slab> frames[kWalkersInTurn];
  take_turns<kNodes, Slab>(
      accel, stacks, counts,
      [&](Walker<Slab>& walker, std::size_t place, NodeRef& from) HWY_ATTR {
        while (next < members.count) {
          RayRecord& record = member<8>(members, next++);
          if (record.tag.flags & kRayDone) continue;
          walker.frame = &frames[place].ray;
          enter_frame(accel, key.instance, record, walker.frame, counts);
          walker.record = &record;
          walker.any_hit = takes_any_hit(record.tag);
          from = key.ref;
          return true;
        }
        return false;
      },
      [](Walker<Slab>& walker) HWY_ATTR { settle(*walker.record); });
  total += counts;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

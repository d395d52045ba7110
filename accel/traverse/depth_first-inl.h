// Depth-first traversal with a stack, nearest child first, for the reference tracer and for visits of a treelet.
#if defined(CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#undef CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#else
#define CAROUSEL_ACCEL_DEPTH_FIRST_INL_H_
#endif

#include <type_traits>

#include <hwy/highway.h>

#include "accel/box/double_slab-inl.h"
#include "accel/box/slab-inl.h"
#include "accel/box/wide_slab-inl.h"
#include "accel/planes/cull_lanes-inl.h"
#include "accel/primitive/local_ray.h"
#include "accel/primitive/triangle_block-inl.h"
#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/stack-inl.h"
#include "core/statistics/intersection_counts.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// The counts of a traversal.
struct TraversalCounts : IntersectionCounts {
  CullCounts* culls;  ///< RayMembers::culls
  explicit TraversalCounts(CullCounts* by_depth) : culls(by_depth) {}
};

/// Takes the lanes from `mask`, children among `lanes` whose boxes the ray hits, that the node's planes show to be
/// missed. With planes first, the boxes of `lanes` that need no test are taken from counts.box.
template <class Slab>
HWY_INLINE std::uint32_t cull(const Accel& accel, const Node& node, const Slab& slab, const Vec3& direction,
                              std::uint32_t lanes, std::uint32_t mask, IntersectionCounts& counts, CullCounts* culls) {
  if constexpr (std::is_same_v<Slab, SlabRay>)  // planes need accuracy.box: conservative
    if (HWY_UNLIKELY(node.plane_counts != 0) && (mask != 0 || accel.planes_first))
      return cull_lanes(accel, node, slab, direction, lanes, mask, counts, culls);
  return mask;
}

HWY_INLINE void count_leaf(NodeRef leaf, IntersectionCounts& counts) {
  (HWY_UNLIKELY(leaf.is_procedural()) ? counts.procedural : counts.triangle) += leaf.triangles();
}

/// The children whose bounding elements the ray meets, with entries. A hit has to lie in its instance's world box, so
/// the box is tested after its element, and counted.
template <class Registers>
HWY_NOINLINE std::uint32_t met_elements(const Accel& accel, NodeRef ref, const Vec3& origin, const Vec3& direction,
                                        const Registers& ray, float tmin, float tmax, float* entry,
                                        std::uint64_t& tested) {
  const Node& node = accel.nodes[ref.node()];
  std::uint32_t met = accel.elements.intersect(ref.node(), node.count, origin, direction, tmin, tmax, entry);
  if (!node.above_instances || met == 0) return met;
  std::uint32_t instances = 0;
  for (int lane = 0; lane < node.count; ++lane) instances |= std::uint32_t{node.child[lane].is_instance()} << lane;
  instances &= ~std::uint32_t{node.direct};
  alignas(64) float ignored[kMaxWidth];
  tested += static_cast<std::uint64_t>(std::popcount(instances & met));
  met &= ~instances | slab_node(node, ray, tmax, ignored);
  return met;
}

/// The kinds of structures by the contents of their nodes beside boxes. A call chooses its code by the kind once: code
/// for contents that are not there would take the plain loop's registers.
enum class Nodes : std::uint8_t {
  kPlain,  ///< boxes alone, or with leaves of their own
  kOther,  ///< other elements, cull planes, or the boxes before quantisation
};

inline Nodes nodes_of(const Accel& accel) {
  return accel.elements.empty() && accel.planes.empty() && accel.full_nodes.empty() ? Nodes::kPlain : Nodes::kOther;
}

/// The lanes of the node's children. No finite ray meets the box of another lane; but every box is met by a ray that is
/// infinite or not a number along each axis, as a ray may become in the space of an instance.
HWY_INLINE std::uint32_t child_lanes(const Node& node) {
  return (1u << node.count) - 1;
}

/// The children of the node at `ref` that the ray meets, in whatever bounds them, with entries; those that the node
/// holds itself are not among them, nor counted.
template <Nodes kNodes, class Slab, class Registers>
HWY_INLINE std::uint32_t met_children(const Accel& accel, NodeRef ref, const LocalRay<Slab>& frame,
                                      const Registers& ray, float tmax, float* entry, std::uint64_t& tested) {
  const Node& node = accel.nodes[ref.node()];
  const std::uint32_t direct = node.direct;
  tested += node.count;
  if (HWY_UNLIKELY(direct != 0)) tested -= static_cast<std::uint64_t>(std::popcount(direct));
  if constexpr (kNodes == Nodes::kOther)
    if (!accel.elements.empty()) {
      std::uint64_t more = 0;  // a counter whose address is known elsewhere would not stay in a register
      const std::uint32_t met =
          met_elements(accel, ref, frame.origin, frame.direction, ray, frame.slab.tmin, tmax, entry, more);
      tested += more;
      return met & ~direct;
    }
  return slab_node(node, ray, tmax, entry) & child_lanes(node) & ~direct;
}

/// Counts the children in `mask` that the ray meets only because their boxes are quantised. Called with full_nodes.
template <class Registers>
HWY_NOINLINE void count_extra_hits(const Accel& accel, NodeRef ref, const Registers& ray, float tmax,
                                   std::uint32_t mask, IntersectionCounts& counts) {
  alignas(64) float ignored[kMaxWidth];
  const std::uint32_t met = slab_node(accel.full_nodes[ref.node()], ray, tmax, ignored);
  counts.extra_box_hits += static_cast<std::uint64_t>(std::popcount(mask & ~met));
}

/// The next action after a visit of anything but an inner node.
enum class Then { kPop, kEnter, kStop };

/// Visits everything below `root`, until `visit_other(ref)`, which is called for all but inner nodes, returns kStop;
/// after kEnter the traversal goes on with the node that `ref` has been set to. Adds the boxes and planes tested to
/// `counts`. True if it was stopped.
template <Nodes kNodes, class Slab, class VisitOther>
HWY_INLINE bool depth_first(const Accel& accel, NodeRef root, const LocalRay<Slab>& frame, const Hit& hit,
                            DepthFirstStack& stack, TraversalCounts& counts, const VisitOther& visit_other) {
  const auto ray = in_registers(frame.slab);
  const Node* const nodes = accel.nodes.data();
  const bool quantised = kNodes == Nodes::kOther && !accel.full_nodes.empty();
  DepthFirstStack::Entry* top = stack.entries;
  NodeRef ref = root;
  std::uint64_t tested = 0;
  for (;;) {
    while (ref.is_inner()) {
      const Node& node = nodes[ref.node()];
      alignas(64) float entry[kMaxWidth];
      std::uint32_t mask = met_children<kNodes>(accel, ref, frame, ray, hit.t, entry, tested);
      for (std::uint32_t left = node.direct; HWY_UNLIKELY(left != 0); left &= left - 1) {
        NodeRef leaf = node.child[std::countr_zero(left)];
        Then then = visit_other(leaf);
        if (then == Then::kEnter) then = visit_other(leaf);  // in the top level: a mesh of the world
        if (then != Then::kStop) continue;
        counts.box += tested;
        return true;
      }
      if constexpr (kNodes == Nodes::kOther)
        mask = cull(accel, node, frame.slab, frame.direction, ~0u, mask, counts, counts.culls);
      if (mask == 0) goto pop;
      if (HWY_UNLIKELY(quantised)) count_extra_hits(accel, ref, ray, hit.t, mask, counts);
      ref = nearest_child(accel, node, mask, entry, top);
    }
    if (const Then then = visit_other(ref); then != Then::kPop) {
      if (then == Then::kEnter) continue;
      counts.box += tested;
      return true;
    }
  pop:
    do {
      if (top == stack.entries) {
        counts.box += tested;
        return false;
      }
      --top;
    } while (top->entry > hit.t);
    ref = NodeRef::from_bits(top->ref);
  }
}

/// Two stacks: one for the nodes of the top level and one for the nodes of an instance. Groups have their own.
struct TraceStacks {
  DepthFirstStack at[2];
};

/// Goes on into an instance without a transform: true, and `ref` is its root. Not into a group, which has a frame of
/// its own in any case, and not beside merged meshes, which are tested in the world's frame and are of no instance.
template <class Slab>
HWY_INLINE bool enter_instance(const Accel& accel, NodeRef& ref, LocalRay<Slab>& frame) {
  const InstanceNode& instance = accel.instances[ref.instance_index()];
  if (!instance.transform.identity || instance.group || accel.merged.count() > 0) return false;
  frame.instance = ref.instance_index();
  ref = instance.root;
  return true;
}

/// Traces `record`'s ray below an instance with a transform, or one that is a group or in a group. True when a search
/// for any hit has found one.
template <Nodes kNodes, class Slab>
HWY_NOINLINE bool trace_instance(const Accel& accel, std::uint32_t instance, RayRecord& record, TraceStacks& stacks,
                                 TraversalCounts& counts);

/// Traces `record`'s ray below `root`, in the frame that was made for it. True when a search for any hit has found one.
/// In the world frame, instances without a transform are entered in passing; `level` is 0 there and 1 below an instance
/// with one.
template <Nodes kNodes, class Slab>
HWY_NOINLINE bool trace_frame(const Accel& accel, NodeRef root, RayRecord& record, LocalRay<Slab>& frame,
                              TraceStacks& stacks, int level, TraversalCounts& counts) {
  const bool any_hit = takes_any_hit(record.tag);
  Hit& hit = record.hit;
  return depth_first<kNodes>(accel, root, frame, hit, stacks.at[level], counts, [&](NodeRef& ref) HWY_ATTR {
    if (HWY_LIKELY(!ref.is_instance())) {
      count_leaf(ref, counts);
      return test_leaf(accel, ref, ~0u, frame, hit) && any_hit ? Then::kStop : Then::kPop;
    }
    if (enter_instance(accel, ref, frame)) return Then::kEnter;
    return trace_instance<kNodes, Slab>(accel, ref.instance_index(), record, stacks, counts) ? Then::kStop : Then::kPop;
  });
}

/// A ray in the space of a group.
HWY_INLINE WideSlabRay group_ray(const Accel& accel, std::uint32_t group, const Ray& world,
                                 IntersectionCounts& counts) {
  const InstanceNode& node = accel.instances[group];
  counts.transforms += !node.transform.identity;
  counts.transforms_in_double += node.transform.promoted;
  return {node.transform.to_model(world), accel.group(group).slack_of(world, node.world)};
}

/// The children among `lanes` of a group's node that the ray meets, with entries.
HWY_INLINE std::uint32_t met_members(const Accel& accel, NodeRef ref, std::uint32_t lanes, const WideSlabLanes& ray,
                                     float tmax, float* entry, IntersectionCounts& counts) {
  const Node& node = accel.nodes[ref.node()];
  lanes &= child_lanes(node);  // an infinite slack lets the ray into every lane
  counts.box += static_cast<std::uint64_t>(std::popcount(lanes));
  const std::uint32_t mask = slab_node(node, ray, tmax, entry) & lanes;
  if (HWY_UNLIKELY(!accel.full_nodes.empty()) && mask != 0) count_extra_hits(accel, ref, ray, tmax, mask, counts);
  return mask;
}

/// The test of a ray that has come out of a group's nodes to one of the group's members: a hit has to lie in its
/// instance's world box, and lies in the world boxes of the groups around it. True if it is missed.
template <class Slab>
HWY_INLINE bool misses_member(const Accel& accel, std::uint32_t instance, const RayRecord& record,
                              IntersectionCounts& counts) {
  float entry;
  ++counts.box;
  return !slab(Slab(record.ray, far_widening(accel.accuracy.box)), accel.instances[instance].world, record.hit.t,
               entry);
}

/// Traces `record`'s ray below a node of a group's structure. True when a search for any hit has found one.
template <Nodes kNodes, class Slab>
HWY_NOINLINE bool trace_group(const Accel& accel, NodeKey key, RayRecord& record, TraceStacks& stacks,
                              TraversalCounts& counts) {
  const WideSlabLanes ray = in_registers(group_ray(accel, key.instance, record.ray, counts));
  const Hit& hit = record.hit;
  DepthFirstStack stack;
  DepthFirstStack::Entry* top = stack.entries;
  NodeRef ref = key.ref;
  for (;;) {
    if (ref.is_inner()) {
      alignas(64) float entry[kMaxWidth];
      const std::uint32_t mask = met_members(accel, ref, ~0u, ray, hit.t, entry, counts);
      if (mask != 0) {
        ref = nearest_child(accel, accel.nodes[ref.node()], mask, entry, top);
        continue;
      }
    } else {
      const std::uint32_t member = accel.instance_at(key.instance, ref);
      if (!misses_member<Slab>(accel, member, record, counts) &&
          trace_instance<kNodes, Slab>(accel, member, record, stacks, counts))
        return true;
    }
    do {
      if (top == stack.entries) return false;
      --top;
    } while (hit.t < top->entry);
    ref = NodeRef::from_bits(top->ref);
  }
}

template <Nodes kNodes, class Slab>
HWY_NOINLINE bool trace_instance(const Accel& accel, std::uint32_t instance, RayRecord& record, TraceStacks& stacks,
                                 TraversalCounts& counts) {
  const NodeRef root = accel.instances[instance].root;
  if (HWY_UNLIKELY(accel.instances[instance].group))
    return trace_group<kNodes, Slab>(accel, {instance, root}, record, stacks, counts);
  FrameStorage<Slab> below;
  enter_frame(accel, instance, record, &below.ray, counts);
  return trace_frame<kNodes>(accel, root, record, below.ray, stacks, 1, counts);
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

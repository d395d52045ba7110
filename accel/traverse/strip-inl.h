// Rays against the shapes of one strip: the boxes of a node, or the triangles of a leaf.
#if defined(CAROUSEL_ACCEL_STRIP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_STRIP_INL_H_
#undef CAROUSEL_ACCEL_STRIP_INL_H_
#else
#define CAROUSEL_ACCEL_STRIP_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <hwy/highway.h>

#include "accel/box/double_slab-inl.h"
#include "accel/box/slab-inl.h"
#include "accel/primitive/nearest_ray.h"
#include "accel/traverse/depth_first-inl.h"
#include "accel/traverse/members-inl.h"
#include "accel/traverse/ray_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// Tests the primitives of the node's own leaves among `lanes`; true when the hit changed.
template <class Slab>
HWY_NOINLINE bool test_direct(const Accel& accel, const Node& node, std::uint32_t lanes, LocalRay<Slab>& frame,
                              Hit& hit, IntersectionCounts& counts) {
  bool changed = false;
  for (std::uint32_t left = node.direct & lanes; left != 0; left &= left - 1) {
    NodeRef leaf = node.child[std::countr_zero(left)];
    if (leaf.is_instance()) enter_instance(accel, leaf, frame);
    count_leaf(leaf, counts);
    changed |= test_leaf(accel, leaf, ~0u, frame, hit);
  }
  return changed;
}

/// Tests the primitives as above, for a ray that is not yet in the node's frame.
template <class Slab>
HWY_NOINLINE void test_direct(const Accel& accel, const Node& node, NodeKey key, std::uint32_t lanes, RayRecord& record,
                              std::vector<AnyHitCall>* any_hit_calls, IntersectionCounts& counts) {
  IntersectionCounts own;
  const WholeRay whole(record);
  FrameStorage<Slab> frame;
  enter_frame(accel, key.instance, record, &frame.ray, own);
  own.transforms = own.transforms_in_double = 0;  // counted with the boxes
  frame.ray.calls = any_hit_calls;
  test_direct(accel, node, lanes, frame.ray, record.hit, own);
  settle(record);
  counts += own;
}

inline constexpr std::size_t kFewestInLanes = 8;  ///< fewer rays are tested one by one

#if HWY_TARGET != HWY_SCALAR
/// test_boxes() for nodes of boxes alone and rays in the world's frame: as many rays together as a register holds.
HWY_INLINE void test_boxes_in_lanes(const Node& node, std::uint32_t children, float widening, const RayMembers& members,
                                    const StripHits& hits, IntersectionCounts& counts) {
  const RayTag d;
  const hn::RebindToUnsigned<RayTag> du;
  RayVec nearest[kMaxWidth];
  for (std::size_t c = 0; c < kMaxWidth; ++c) nearest[c] = hn::Set(d, kInfinity);
  for (std::size_t i = 0; i < members.count; i += kRayLanes) {
    const std::size_t count = std::min(kRayLanes, members.count - i);
    const RayRecord* rays[kRayLanes];
    std::uint32_t wanted = 0;
    for (std::size_t lane = 0; lane < count; ++lane) rays[lane] = &member<2 * kRayLanes>(members, i + lane);
    for (std::size_t lane = count; lane < kRayLanes; ++lane) rays[lane] = rays[0];
    for (std::size_t lane = 0; lane < count; ++lane)
      wanted |= std::uint32_t{(rays[lane]->tag.flags & kRayDone) == 0} << lane;
    const BoxLanes lanes(rays, widening);
    const std::uint8_t wanted_bytes[8] = {static_cast<std::uint8_t>(wanted), static_cast<std::uint8_t>(wanted >> 8)};
    const auto all = hn::LoadMaskBits(d, wanted_bytes);
    auto masks = hn::Zero(du);
    for (std::uint32_t left = children; left != 0; left &= left - 1) {
      const auto c = static_cast<std::size_t>(std::countr_zero(left));
      RayVec entry;
      const auto met = hn::And(lanes.meet(node, c, entry), all);
      nearest[c] = keep_min(hn::IfThenElse(met, entry, nearest[c]), nearest[c]);
      masks = hn::Or(masks, hn::IfThenElseZero(hn::RebindMask(du, met), hn::Set(du, 1u << c)));
    }
    alignas(16) std::uint8_t bytes[kRayLanes];
    hn::Store(hn::U8FromU32(masks), hn::Rebind<std::uint8_t, RayTag>(), bytes);
    std::copy(bytes, bytes + count, hits.masks + i);
    counts.box += static_cast<std::uint64_t>(std::popcount(children) * std::popcount(wanted));
  }
  for (std::uint32_t left = children; left != 0; left &= left - 1) {
    const int c = std::countr_zero(left);
    hits.nearest[c] = std::min(hits.nearest[c], hn::GetLane(hn::MinOfLanes(d, nearest[c])));
  }
}
#endif

// Slab: SlabRay, or DoubleSlabRay for accuracy.box: double. kMember: Accel::enters_member() of the key.
template <class Slab, bool kMember>
void test_boxes(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
                IntersectionCounts& counts) {
  const Node& node = accel.nodes[key.ref.node()];
  const InstanceTransform* transform = key.instance == kNoInstance ? nullptr : &accel.instances[key.instance].transform;
  lanes &= child_lanes(node);
  const std::uint32_t direct = node.direct & lanes, held = ~std::uint32_t{node.direct};
  const std::uint64_t boxes = static_cast<std::uint64_t>(std::popcount(lanes & held));
  const float widening = far_widening(accel.accuracy.box);
  const bool quantised = !accel.full_nodes.empty();
#if HWY_TARGET != HWY_SCALAR
  if constexpr (std::is_same_v<Slab, SlabRay> && !kMember)
    if ((transform == nullptr || transform->identity) && node.plane_counts == 0 && accel.elements.empty() &&
        !quantised && direct == 0 && hits.entries == nullptr && members.count >= kFewestInLanes)
      return test_boxes_in_lanes(node, lanes & held, widening, members, hits, counts);
#endif
  alignas(64) float nearest[kMaxWidth];
  std::copy(hits.nearest, hits.nearest + kMaxWidth, nearest);
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member<16>(members, i);
    if (record.tag.flags & kRayDone) {
      hits.masks[i] = 0;
      continue;
    }
    if constexpr (kMember)
      if (misses_member<Slab>(accel, key.instance, record, counts)) {
        hits.masks[i] = 0;
        continue;
      }
    const bool move = transform != nullptr && !transform->identity;
    const Ray model = move ? transform->to_model(record.ray) : record.ray;
    const Slab ray(model, widening);
    counts.transforms += move;
    counts.transforms_in_double += move && transform->promoted;
    counts.box += boxes;
    alignas(64) float entry[kMaxWidth];
    std::uint32_t mask;
    if (HWY_LIKELY(node.plane_counts == 0 && accel.elements.empty())) {
      mask = slab_node(node, in_registers(ray), record.hit.t, entry, nearest) & lanes & held;
    } else {
      mask = accel.elements.empty() ? slab_node(node, in_registers(ray), record.hit.t, entry)
                                    : met_elements(accel, key.ref, model.origin, model.direction, in_registers(ray),
                                                   model.tmin, record.hit.t, entry, counts.box);
      mask &= lanes & held;
      mask = cull(accel, node, ray, model.direction, lanes, mask, counts, members.culls);
      for (int lane = 0; lane < kMaxWidth; ++lane)
        if (mask >> lane & 1) nearest[lane] = std::min(nearest[lane], entry[lane]);
    }
    if (HWY_UNLIKELY(quantised) && mask != 0)
      count_extra_hits(accel, key.ref, in_registers(ray), record.hit.t, mask, counts);
    if (HWY_UNLIKELY(direct != 0)) test_direct<Slab>(accel, node, key, direct, record, members.any_hit_calls, counts);
    hits.masks[i] = static_cast<std::uint8_t>(mask);
    if (hits.entries != nullptr) std::memcpy(hits.entries + kMaxWidth * i, entry, sizeof entry);
  }
  for (int lane = 0; lane < kMaxWidth; ++lane)
    if (lanes >> lane & 1) hits.nearest[lane] = nearest[lane];
}

/// The nodes of a group: boxes alone.
template <class Slab>
void test_members(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
                  const StripHits& hits, IntersectionCounts& counts) {
  const bool enters = accel.enters_member(key);
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member<16>(members, i);
    hits.masks[i] = 0;
    if ((record.tag.flags & kRayDone) != 0) continue;
    if (enters && misses_member<Slab>(accel, key.instance, record, counts)) continue;
    alignas(64) float entry[kMaxWidth];
    const WideSlabLanes ray = in_registers(group_ray(accel, key.instance, record.ray, counts));
    const std::uint32_t mask = met_members(accel, key.ref, lanes, ray, record.hit.t, entry, counts);
    for (std::uint32_t left = mask; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      hits.nearest[lane] = std::min(hits.nearest[lane], entry[lane]);
    }
    hits.masks[i] = static_cast<std::uint8_t>(mask);
    if (hits.entries != nullptr) std::memcpy(hits.entries + kMaxWidth * i, entry, sizeof entry);
  }
}

template <class Slab, bool kMember>
void test_triangles(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
                    IntersectionCounts& counts) {
  lanes &= (1u << key.ref.triangles()) - 1;
  const std::uint64_t tested = static_cast<std::uint64_t>(std::popcount(lanes));
  std::uint64_t& tests = key.ref.is_procedural() ? counts.procedural : counts.triangle;
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member<4>(members, i);
    if (record.tag.flags & kRayDone) continue;
    if constexpr (kMember)
      if (misses_member<Slab>(accel, key.instance, record, counts)) continue;
    tests += tested;
    const WholeRay whole(record);
    FrameStorage<Slab> frame;
    enter_frame(accel, key.instance, record, &frame.ray, counts);
    frame.ray.calls = members.any_hit_calls;
    test_leaf(accel, key.ref, lanes, frame.ray, record.hit);
    settle(record);
  }
}

template <class Slab, bool kMember>
void test_shapes(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
                 IntersectionCounts& counts) {
  if (key.ref.is_inner())
    test_boxes<Slab, kMember>(accel, key, lanes, members, hits, counts);
  else
    test_triangles<Slab, kMember>(accel, key, lanes, members, counts);
}

template <class Slab>
void test_any_level(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
                    const StripHits& hits, IntersectionCounts& counts) {
  if (HWY_UNLIKELY(accel.is_group(key.instance)))
    test_members<Slab>(accel, key, lanes, members, hits, counts);
  else if (HWY_UNLIKELY(accel.enters_member(key)))
    test_shapes<Slab, true>(accel, key, lanes, members, hits, counts);
  else
    test_shapes<Slab, false>(accel, key, lanes, members, hits, counts);
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

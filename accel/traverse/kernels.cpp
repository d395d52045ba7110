#include "accel/traverse/kernels.h"

#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/traverse/kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "accel/box/double_slab-inl.h"
#include "accel/box/slab-inl.h"
#include "accel/traverse/depth_first-inl.h"
#include "accel/traverse/interleaved-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

// Records of one packet lie scattered in the store; those to come are fetched while this one is tested. `kAhead` makes
// up for the wait: the more, the shorter the tests of one record.
template <std::size_t kAhead>
HWY_INLINE RayRecord& member(const RayMembers& members, std::size_t i) {
  if (members.slots == nullptr) return members.records[i];
  if (i + kAhead < members.count) __builtin_prefetch(&members.records[members.slots[i + kAhead]], 1);
  return members.records[members.slots[i]];
}

HWY_INLINE void settle(RayRecord& record) {
  if (takes_any_hit(record.tag) && record.hit.valid()) record.tag.flags |= kRayDone;
}

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

/// The same for a ray that is not yet in the node's frame.
template <class Slab>
HWY_NOINLINE void test_direct(const Accel& accel, const Node& node, NodeKey key, std::uint32_t lanes, RayRecord& record,
                              std::uint8_t* any_hit_calls, IntersectionCounts& counts) {
  IntersectionCounts own;
  FrameStorage<Slab> frame;
  enter_frame(accel, key.instance, record, &frame.ray, own);
  own.transforms = own.transforms_in_double = 0;  // counted with the boxes
  test_direct(accel, node, lanes, frame.ray, record.hit, own);
  settle(record);
  if (any_hit_calls != nullptr)
    *any_hit_calls = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, own.any_hit_calls));
  counts += own;
}

// Slab: SlabRay, or DoubleSlabRay for accuracy.box: double. kMember: Accel::enters_member() of the key.
template <class Slab, bool kMember>
void test_boxes(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
                IntersectionCounts& counts) {
  const Node& node = accel.nodes[key.ref.node()];
  const InstanceTransform* transform = key.instance == kNoInstance ? nullptr : &accel.instances[key.instance].transform;
  lanes &= (1u << node.count) - 1;
  const std::uint32_t direct = node.direct & lanes, held = ~std::uint32_t{node.direct};
  const std::uint64_t boxes = static_cast<std::uint64_t>(std::popcount(lanes & held));
  const float widening = far_widening(accel.accuracy.box);
  const bool quantised = !accel.full_nodes.empty();
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
    if (HWY_LIKELY(node.plane_counts == 0 && accel.spheres.empty())) {
      mask = slab_node(node, in_registers(ray), record.hit.t, entry, nearest) & lanes & held;
    } else {
      mask = accel.spheres.empty() ? slab_node(node, in_registers(ray), record.hit.t, entry)
                                   : met_spheres(accel, key.ref, model.origin, model.direction, in_registers(ray),
                                                 model.tmin, record.hit.t, entry, counts.box);
      mask &= lanes & held;
      mask = cull(accel, node, ray, model.direction, lanes, mask, counts, members.culls);
      for (int lane = 0; lane < kMaxWidth; ++lane)
        if (mask >> lane & 1) nearest[lane] = std::min(nearest[lane], entry[lane]);
    }
    if (HWY_UNLIKELY(quantised) && mask != 0)
      count_extra_hits(accel, key.ref, in_registers(ray), record.hit.t, mask, counts);
    if (HWY_UNLIKELY(direct != 0))
      test_direct<Slab>(accel, node, key, direct, record,
                        members.any_hit_calls == nullptr ? nullptr : members.any_hit_calls + i, counts);
    hits.masks[i] = static_cast<std::uint8_t>(mask);
    if (hits.entries != nullptr) std::copy(entry, entry + kMaxWidth, hits.entries + kMaxWidth * i);
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
    if (hits.entries != nullptr) std::copy(entry, entry + kMaxWidth, hits.entries + kMaxWidth * i);
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
    const std::uint64_t any_hit_calls = counts.any_hit_calls;
    FrameStorage<Slab> frame;
    enter_frame(accel, key.instance, record, &frame.ray, counts);
    test_leaf(accel, key.ref, lanes, frame.ray, record.hit);
    if (members.any_hit_calls != nullptr)
      members.any_hit_calls[i] = static_cast<std::uint8_t>(counts.any_hit_calls - any_hit_calls);  // 32 at most
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

template <class Slab>
void trace_one_by_one(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  TraceStacks stacks;
  TraversalCounts counts(members.culls);
  const bool enters = accel.enters_member(key), in_group = accel.is_group(key.instance);
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member<4>(members, i);
    if (record.tag.flags & kRayDone) continue;
    if (enters && misses_member<Slab>(accel, key.instance, record, counts)) continue;
    if (in_group) {
      trace_group<Slab>(accel, key, record, stacks, counts);
    } else {
      FrameStorage<Slab> frame;
      enter_frame(accel, key.instance, record, &frame.ray, counts);
      trace_frame(accel, key.ref, record, frame.ray, stacks, 0, counts);
    }
    settle(record);
  }
  total += counts;
}

template <class Slab>
void trace_in_turn(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  constexpr std::size_t kWalkers = 4;  // two gain half as much, six nothing more
  const Node* const nodes = accel.nodes.data();
  TraceStacks stacks;
  TraversalCounts counts(members.culls);
  std::size_t next = 0;
  Walker<Slab> walkers[kWalkers];
  Walker<Slab>* active[kWalkers];
  std::size_t count = 0;
  const bool quantised = !accel.full_nodes.empty();
  const auto start = [&](Walker<Slab>& walker) HWY_ATTR {
    while (next < members.count) {
      RayRecord& record = member<8>(members, next++);
      if (record.tag.flags & kRayDone) continue;
      enter_frame(accel, key.instance, record, &walker.frame.ray, counts);
      walker.record = &record;
      walker.any_hit = takes_any_hit(record.tag);
      walker.top = walker.stack.entries;
      if (walk_on(accel, walker, true, key.ref, stacks, counts)) return true;
      settle(record);
    }
    return false;
  };
  for (Walker<Slab>& walker : walkers)
    if (start(walker)) active[count++] = &walker;
  while (count > 0) {
    for (std::size_t k = 0; k < count; ++k) {
      Walker<Slab>& walker = *active[k];
      const Node& node = nodes[walker.ref.node()];
      LocalRay<Slab>& frame = walker.frame.ray;
      walker.mask = met_children(accel, walker.ref, frame, in_registers(frame.slab), walker.record->hit.t, walker.entry,
                                 counts.box);
      walker.mask = cull(accel, node, frame.slab, frame.direction, ~0u, walker.mask, counts, members.culls);
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
      if (!walk_on(accel, walker, any, ref, stacks, counts)) {
        settle(*walker.record);
        if (!start(walker)) {
          std::swap(active[k], active[--count]);
          continue;
        }
      }
      ++k;
    }
  }
  total += counts;
}

void TestStrip(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
               IntersectionCounts& counts) {
  const bool in_double = accel.accuracy.box == BoxLevel::kDouble;
  (in_double ? test_any_level<DoubleSlabRay> : test_any_level<SlabRay>)(accel, key, lanes, members, hits, counts);
}

void TraceSubtree(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  const bool in_double = accel.accuracy.box == BoxLevel::kDouble;
  (in_double ? trace_one_by_one<DoubleSlabRay> : trace_one_by_one<SlabRay>)(accel, key, members, counts);
}

void TraceInterleaved(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  if (accel.is_group(key.instance) || accel.enters_member(key)) return TraceSubtree(accel, key, members, counts);
  const bool in_double = accel.accuracy.box == BoxLevel::kDouble;
  (in_double ? trace_in_turn<DoubleSlabRay> : trace_in_turn<SlabRay>)(accel, key, members, counts);
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

#include "accel/exact/exact_triangle.h"
#include "core/system/error.h"

namespace carousel::accel {

HWY_EXPORT(TestStrip);
HWY_EXPORT(TraceSubtree);
HWY_EXPORT(TraceInterleaved);

namespace {

/// Adds the exact volumes computed in this thread during its life.
class ExactVolumeCount {
 public:
  explicit ExactVolumeCount(IntersectionCounts& counts) : counts_(counts), before_(exact_volumes()) {}
  ~ExactVolumeCount() { counts_.exact_volumes += exact_volumes() - before_; }
  ExactVolumeCount(const ExactVolumeCount&) = delete;

 private:
  IntersectionCounts& counts_;
  std::uint64_t before_;
};

}  // namespace

void test_strip(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
                IntersectionCounts& counts) {
  const ExactVolumeCount volumes(counts);
  HWY_DYNAMIC_DISPATCH(TestStrip)(accel, key, lanes, members, hits, counts);
}

void trace_subtree(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  const ExactVolumeCount volumes(counts);
  HWY_DYNAMIC_DISPATCH(TraceSubtree)(accel, key, members, counts);
}

void trace_interleaved(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  const ExactVolumeCount volumes(counts);
  HWY_DYNAMIC_DISPATCH(TraceInterleaved)(accel, key, members, counts);
}

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
  return names;
}

void select_simd_target(SimdTarget target) {
  std::int64_t wanted = 0;
  switch (target) {
    case SimdTarget::kAuto:
      hwy::SetSupportedTargetsForTest(0);
      hwy::GetChosenTarget().DeInit();
      return;
    case SimdTarget::kScalar:
      wanted = HWY_SCALAR;
      break;
    case SimdTarget::kSsse3:
      wanted = HWY_SSSE3;
      break;
    case SimdTarget::kSse4:
      wanted = HWY_SSE4;
      break;
    case SimdTarget::kAvx2:
      wanted = HWY_AVX2;
      break;
    case SimdTarget::kAvx3:
      wanted = HWY_AVX3;
      break;
  }
  hwy::SetSupportedTargetsForTest(0);
  const std::vector<std::int64_t> available = hwy::SupportedAndGeneratedTargets();
  if (std::find(available.begin(), available.end(), wanted) == available.end()) {
    std::string names;
    for (const std::string& name : simd_targets()) names += (names.empty() ? "" : ", ") + name;
    ConfigIssue issue;
    issue.key_path = "engine.simd";
    issue.message = std::string("this machine or build has no ") + hwy::TargetName(wanted) + "; it has " + names;
    throw ConfigError({issue});
  }
  hwy::SetSupportedTargetsForTest(wanted);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace carousel::accel
#endif  // HWY_ONCE

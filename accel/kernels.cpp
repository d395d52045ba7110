#include "accel/kernels.h"

#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/kernels.cpp"
#include <hwy/foreach_target.h>   // IWYU pragma: keep

#include <hwy/highway.h>

#include "accel/depth_first-inl.h"
#include "accel/slab-inl.h"
#include "accel/watertight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

// Records of one packet lie scattered in the store; those to come are fetched while this one is tested.
HWY_INLINE RayRecord& member(const RayMembers& members, std::size_t i) {
  if (members.slots == nullptr) return members.records[i];
  if (i + 4 < members.count) __builtin_prefetch(&members.records[members.slots[i + 4]], 1);
  return members.records[members.slots[i]];
}

HWY_INLINE void settle(RayRecord& record) {
  if (record.tag.kind == RayKind::kShadow && record.hit.valid()) record.tag.flags |= kRayDone;
}

void TestBoxes(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
               const StripHits& hits, TestCounts& counts) {
  const Node& node = accel.nodes[key.ref.node()];
  const InstanceTransform* transform =
      key.instance == kNoInstance ? nullptr : &accel.instances[key.instance].transform;
  lanes &= (1u << node.count) - 1;
  const std::uint64_t boxes = static_cast<std::uint64_t>(std::popcount(lanes));
  float nearest[kMaxWidth];
  std::copy(hits.nearest, hits.nearest + kMaxWidth, nearest);
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member(members, i);
    if (record.tag.flags & kRayDone) {
      hits.masks[i] = 0;
      continue;
    }
    const bool move = transform != nullptr && !transform->identity;
    const SlabRay ray(move ? transform->to_model(record.ray) : record.ray);
    counts.transforms += move;
    counts.box += boxes;
    alignas(64) float entry[kMaxWidth];
    const std::uint32_t mask = slab_node(node, SlabLanes(ray), record.hit.t, entry) & lanes;
    hits.masks[i] = static_cast<std::uint8_t>(mask);
    for (std::uint32_t rest = mask; rest != 0; rest &= rest - 1) {
      const int lane = std::countr_zero(rest);
      nearest[lane] = entry[lane] < nearest[lane] ? entry[lane] : nearest[lane];
    }
    if (hits.entries != nullptr) std::copy(entry, entry + kMaxWidth, hits.entries + kMaxWidth * i);
  }
  std::copy(nearest, nearest + kMaxWidth, hits.nearest);
}

void TestTriangles(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
                   TestCounts& counts) {
  const InstanceNode& instance = accel.instances[key.instance];
  lanes &= (1u << key.ref.triangles()) - 1;
  const std::uint64_t tested = static_cast<std::uint64_t>(std::popcount(lanes));
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member(members, i);
    if (record.tag.flags & kRayDone) continue;
    const SlabRay world(record.ray);
    counts.triangle += tested;
    in_instance(instance, key.instance, record.ray, world, instance_entry(instance, world), counts,
                [&](const FrameRay& ray) HWY_ATTR { return test_leaf(accel, key.ref, lanes, ray, record.hit); });
    settle(record);
  }
}

void TestStrip(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
               const StripHits& hits, TestCounts& counts) {
  if (key.ref.is_inner())
    TestBoxes(accel, key, lanes, members, hits, counts);
  else
    TestTriangles(accel, key, lanes, members, counts);
}

void TraceSubtree(const Accel& accel, NodeKey key, const RayMembers& members, TestCounts& total) {
  DepthFirstStack world_stack, model_stack;
  TestCounts counts;
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member(members, i);
    if (record.tag.flags & kRayDone) continue;
    const bool any_hit = record.tag.kind == RayKind::kShadow;
    const SlabRay world(record.ray);
    const auto below_instance = [&](std::uint32_t index, NodeRef root, float entry) HWY_ATTR {
      return in_instance(accel.instances[index], index, record.ray, world, entry, counts,
                         [&](const FrameRay& ray) HWY_ATTR {
                           return trace_instance(accel, root, ray, any_hit, record.hit, model_stack, counts);
                         });
    };
    if (key.instance != kNoInstance) {
      below_instance(key.instance, key.ref, instance_entry(accel.instances[key.instance], world));
    } else {
      depth_first(accel, key.ref, world, record.hit, world_stack, counts.box, [&](NodeRef ref) HWY_ATTR {
        const std::uint32_t index = ref.instance_index();
        return below_instance(index, accel.instances[index].root, instance_entry(accel.instances[index], world));
      });
    }
    settle(record);
  }
  total += counts;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>

#include "core/error.h"

namespace carousel::accel {

HWY_EXPORT(TestStrip);
HWY_EXPORT(TraceSubtree);

void test_strip(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members,
                const StripHits& hits, TestCounts& counts) {
  HWY_DYNAMIC_DISPATCH(TestStrip)(accel, key, lanes, members, hits, counts);
}

void trace_subtree(const Accel& accel, NodeKey key, const RayMembers& members, TestCounts& counts) {
  HWY_DYNAMIC_DISPATCH(TraceSubtree)(accel, key, members, counts);
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
    case SimdTarget::kScalar: wanted = HWY_SCALAR; break;
    case SimdTarget::kSsse3: wanted = HWY_SSSE3; break;
    case SimdTarget::kSse4: wanted = HWY_SSE4; break;
    case SimdTarget::kAvx2: wanted = HWY_AVX2; break;
    case SimdTarget::kAvx3: wanted = HWY_AVX3; break;
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

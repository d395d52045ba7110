#include "accel/traverse/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/traverse/kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include "accel/box/double_slab-inl.h"
#include "accel/box/slab-inl.h"
#include "accel/traverse/depth_first-inl.h"
#include "accel/traverse/interleaved-inl.h"
#include "accel/traverse/members-inl.h"
#include "accel/traverse/stream-inl.h"
#include "accel/traverse/strip-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// Traces the members one after another, each through everything below `key`.
template <Nodes kNodes, class Slab>
void trace_one_by_one(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  TraceStacks stacks;
  TraversalCounts counts(members.culls);
  const bool enters = accel.enters_member(key), in_group = accel.is_group(key.instance);
  for (std::size_t i = 0; i < members.count; ++i) {
    RayRecord& record = member<4>(members, i);
    if (record.tag.flags & kRayDone) continue;
    if (enters && misses_member<Slab>(accel, key.instance, record, counts)) continue;
    if (in_group) {
      trace_group<kNodes, Slab>(accel, key, record, stacks, counts);
    } else {
      FrameStorage<Slab> frame;
      enter_frame(accel, key.instance, record, &frame.ray, counts);
      trace_frame<kNodes>(accel, key.ref, record, frame.ray, stacks, 0, counts);
    }
    settle(record);
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
  const bool plain = nodes_of(accel) == Nodes::kPlain;
  (in_double ? trace_one_by_one<Nodes::kOther, DoubleSlabRay>
   : plain   ? trace_one_by_one<Nodes::kPlain, SlabRay>
             : trace_one_by_one<Nodes::kOther, SlabRay>)(accel, key, members, counts);
}

void TraceInterleaved(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  if (accel.is_group(key.instance) || accel.enters_member(key)) return TraceSubtree(accel, key, members, counts);
  const bool in_double = accel.accuracy.box == BoxLevel::kDouble;
  const bool plain = nodes_of(accel) == Nodes::kPlain;
  (in_double ? trace_in_turn<Nodes::kOther, DoubleSlabRay>
   : plain   ? trace_in_turn<Nodes::kPlain, SlabRay>
             : trace_in_turn<Nodes::kOther, SlabRay>)(accel, key, members, counts);
}

void TraceStream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  const bool lists = nodes_of(accel) == Nodes::kPlain && accel.accuracy.box != BoxLevel::kDouble &&
                     !accel.is_group(key.instance) && !accel.enters_member(key);
  lists ? trace_in_stream(accel, key, members, counts) : TraceInterleaved(accel, key, members, counts);
}

bool HasLists() {
  return HWY_MAX_BYTES >= 64;
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
HWY_EXPORT(TraceStream);
HWY_EXPORT(HasLists);

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

void trace_stream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts) {
  const ExactVolumeCount volumes(counts);
  HWY_DYNAMIC_DISPATCH(TraceStream)(accel, key, members, counts);
}

bool has_lists() {
  return HWY_DYNAMIC_DISPATCH(HasLists)();
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
    throw ConfigError("engine.simd",
                      std::string("this machine or build has no ") + hwy::TargetName(wanted) + "; it has " + names);
  }
  hwy::SetSupportedTargetsForTest(wanted);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace carousel::accel
#endif  // HWY_ONCE

// The records of a kernel's call: reading them one after another, and marking those whose search has ended.
#if defined(CAROUSEL_ACCEL_MEMBERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_MEMBERS_INL_H_
#undef CAROUSEL_ACCEL_MEMBERS_INL_H_
#else
#define CAROUSEL_ACCEL_MEMBERS_INL_H_
#endif

#include <cstddef>

#include <hwy/highway.h>

#include "accel/traverse/kernels.h"

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

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

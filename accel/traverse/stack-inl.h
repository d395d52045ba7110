// The stack of a depth-first traversal, and the order in which a node's children go onto it.
#if defined(CAROUSEL_ACCEL_STACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_STACK_INL_H_
#undef CAROUSEL_ACCEL_STACK_INL_H_
#else
#define CAROUSEL_ACCEL_STACK_INL_H_
#endif

#include <bit>
#include <cstdint>
#include <utility>

#include <hwy/highway.h>

#include "accel/structure/accel.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// Nodes on a traversal stack at most: binary depth is at most 72 (accel/builders/binary/sah_build.cpp), above the
/// instances and again below one that is entered in passing; a level leaves at most seven siblings behind.
inline constexpr int kStackCapacity = 1024;

/// Nodes that wait for their turn, a node's nearest child on top.
struct DepthFirstStack {
  struct Entry {
    float entry;
    std::uint32_t ref;  // bits of a NodeRef, which would be initialised: 1024 times a call for nothing
  };
  Entry entries[kStackCapacity];
};

HWY_INLINE void prefetch_lines(const void* bytes) {
  for (std::size_t line = 0; line < sizeof(Node); line += 64)
    __builtin_prefetch(static_cast<const char*>(bytes) + line);
}

HWY_INLINE void prefetch_block(const Accel& accel, NodeRef leaf) {
  const char* const bytes = reinterpret_cast<const char*>(accel.blocks.data() + leaf.first_block());
  for (std::size_t line = 0; line < sizeof(TriangleBlock); line += 64) __builtin_prefetch(bytes + line);
}

/// Prefetches a stacked node, so that it arrives from memory while nearer nodes are visited.
HWY_INLINE void prefetch(const Accel& accel, NodeRef ref) {
  if (ref.is_inner())
    prefetch_lines(accel.nodes.data() + ref.node());
  else
    prefetch_lines(accel.blocks.data() + ref.first_block());  // an instance: some block, which does no harm
}

/// The nearest of the children in `mask`, which is not empty; the others are pushed, the nearest of them on top.
HWY_INLINE NodeRef nearest_child(const Accel& accel, const Node& node, std::uint32_t mask, const float* entry,
                                 DepthFirstStack::Entry*& top) {
  const int first = std::countr_zero(mask);
  mask &= mask - 1;
  if (mask == 0) return node.child[first];
  const int second = std::countr_zero(mask);
  mask &= mask - 1;
  // Selected by arithmetic: compilers make a branch of a conditional, and which of the two is nearer is hard to guess.
  const int flip = -static_cast<int>(entry[second] < entry[first]) & (first ^ second);
  const int near_lane = first ^ flip, far_lane = second ^ flip;
  DepthFirstStack::Entry nearest{entry[near_lane], node.child[near_lane].bits()};
  DepthFirstStack::Entry* const bottom = top;
  *top++ = {entry[far_lane], node.child[far_lane].bits()};
  prefetch(accel, node.child[far_lane]);
  for (; mask != 0; mask &= mask - 1) {
    const int lane = std::countr_zero(mask);
    DepthFirstStack::Entry other{entry[lane], node.child[lane].bits()};
    if (other.entry < nearest.entry) std::swap(other, nearest);
    DepthFirstStack::Entry* at = top++;
    for (; at > bottom && at[-1].entry < other.entry; --at) *at = at[-1];
    *at = other;
  }
  return NodeRef::from_bits(nearest.ref);
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard

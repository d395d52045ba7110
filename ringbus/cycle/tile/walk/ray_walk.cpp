#include "ringbus/cycle/tile/walk/ray_walk.h"

#include <algorithm>
#include <utility>

#include "accel/packed/packed_leaves.h"
#include "accel/primitive/nearest_ray.h"
#include "ringbus/resource/visit/last_first.h"

namespace carousel::ringbus::cycle {

namespace {

std::uint64_t entry_bytes(accel::NodeKey key) {
  return key.ref.is_inner() ? 4 : 12;
}

}  // namespace

void RayWalk::start(accel::NodeKey from, const accel::TreePieces* pieces, bool in_rounds) {
  pieces_ = pieces;
  in_rounds_ = in_rounds;
  exits_.clear();
  stack_.assign(1, {from, 0, 0, true});
  next_in_hand_ = true;
  instance_ = kNoInstance;
  bytes_ = {};
}

std::optional<accel::NodeKey> RayWalk::next(const RayRecord& record, std::size_t beyond, bool tested) {
  if ((record.tag.flags & kRayDone) != 0) {
    // Waiting nodes are forgotten without being read.
    stack_.clear();
    next_in_hand_ = false;
    bytes_.held = 0;
  }
  accel::NearestRay* const nearest = accel::nearest_of(record);
  while (stack_.size() > beyond) {
    const NextNode top = pop();
    if (top.entry > record.hit.t) continue;
    if (nearest != nullptr && nearest->set_aside({top.key, top.entry, top.depth})) continue;
    depth_ = top.depth;
    return top.key;
  }
  if (nearest == nullptr || !in_rounds_ || beyond > 0 || !tested) return std::nullopt;
  const std::optional<accel::WaitingNode> next = nearest->go_on();
  if (!next) return std::nullopt;
  depth_ = next->depth;
  return next->key;
}

std::uint64_t RayWalk::bytes_of(std::size_t first, std::size_t last) const {
  std::uint64_t bytes = 0;
  for (std::size_t i = first; i < last; ++i) bytes += entry_bytes(stack_[i].key);
  return bytes;
}

NextNode RayWalk::pop() {
  const NextNode top = stack_.back();
  stack_.pop_back();
  if (std::exchange(next_in_hand_, false)) return top;
  bytes_.popped += entry_bytes(top.key);
  bytes_.held -= entry_bytes(top.key);
  return top;
}

void RayWalk::enter(std::uint32_t instance, std::uint32_t slot, IntersectionCounts& counts) {
  instance_ = instance;
  if (!transforms_->moves(instance) || !transforms_->needs(slot, instance)) return;
  TransformCounts own;
  transforms_->invert(instance, own);
  ++counts.transforms;
  counts.transforms_in_double += transforms_->in_double(instance);
  counts.inversions += own.inversions;
  counts.full_inversions += own.full_inversions;
  counts.inversions_in_double += own.inversions_in_double;
}

void RayWalk::test(const accel::Accel& accel, accel::NodeKey key, const accel::RayMembers& ray,
                   IntersectionCounts& counts) {
  std::uint8_t mask = 0;
  float nearest[accel::kMaxWidth], entry[accel::kMaxWidth];
  std::fill(std::begin(nearest), std::end(nearest), kInfinity);
  const std::uint64_t transforms = counts.transforms, in_double = counts.transforms_in_double;
  accel::test_strip(accel, key, ~0u, ray, {&mask, nearest, entry}, counts);
  if (accel::NearestRay* const several = accel::nearest_of(ray.records[*ray.slots])) several->visited();
  counts.transforms = transforms;  // without the kernel's own, for every strip
  counts.transforms_in_double = in_double;
  if (key.instance != instance_) enter(key.instance, *ray.slots, counts);
  counts.decoded += accel::blocks_to_decode(accel, key.ref);
  if (!key.ref.is_inner() || mask == 0) return;
  std::uint64_t bytes = 0;
  const std::size_t waiting = stack_.size();
  const auto met = static_cast<std::ptrdiff_t>(exits_.size());
  last_first(order_, mask, entry, [&](int lane) {
    const NextNode child{accel.child_key(key, lane), entry[lane], static_cast<std::uint16_t>(depth_ + 1), true};
    if (pieces_ != nullptr && !pieces_->together(key.ref, accel.nodes[key.ref.node()].child[lane]))
      return exits_.push_back(child);
    stack_.push_back(child);
    bytes += entry_bytes(child.key);
  });
  std::reverse(exits_.begin() + met, exits_.end());
  if (stack_.size() == waiting) return;
  // The first child of a strip that was tested before this one goes onto the stack after all.
  if (next_in_hand_) bytes += entry_bytes(stack_[waiting - 1].key);
  bytes -= entry_bytes(stack_.back().key);
  next_in_hand_ = true;
  bytes_.held += bytes;
  bytes_.pushed += bytes;
}

}  // namespace carousel::ringbus::cycle

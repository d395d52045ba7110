#pragma once

#include <cstdint>
#include <span>

#include "accel/structure/accel.h"
#include "accel/traverse/kernels.h"
#include "core/statistics/cull_counts.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/visit/any_hit_hold.h"
#include "ringbus/resource/visit/completion.h"
#include "ringbus/resource/visit/memory_blocks.h"
#include "ringbus/resource/visit/subtree_tracer.h"
#include "ringbus/resource/visit/transform_account.h"

namespace carousel::ringbus {

/// The parts of a resource that a packet's visit works with. Nothing is owned; the pointers may be null.
struct VisitContext {
  const accel::Accel& accel;
  RayStore& store;
  Completion& completion;
  AnyHitHold& any_hit;
  CullCounts* culls;
  SubtreeTracer* subtree_tracer;
  TransformAccount* transforms;
  const MemoryBlocks* blocks = nullptr;  ///< null: collections are keyed by nodes

  /// The rays of `slots`, as the kernels take them for one test.
  accel::RayMembers members(std::span<const std::uint32_t> slots) const {
    return {store.records(), slots.data(), slots.size(), culls, any_hit.next_test()};
  }
};

/// Charges the rays of a visit with being brought to model space by the engine's own account, if it has one, instead
/// of the kernels' count. It is made before the tests, which may complete rays.
class TransformCharge {
 public:
  TransformCharge(const VisitContext& context, std::span<const std::uint32_t> slots, std::uint32_t instance)
      : accounted_(context.transforms != nullptr) {
    if (accounted_) charged_ = context.transforms->charge(context.store.records(), slots, instance);
  }
  /// After the tests.
  void write(IntersectionCounts& counts) const {
    if (!accounted_) return;
    counts.transforms = charged_.transforms;
    counts.transforms_in_double = charged_.transforms_in_double;
    counts.inversions = charged_.inversions;
    counts.full_inversions = charged_.full_inversions;
    counts.inversions_in_double = charged_.inversions_in_double;
  }

 private:
  bool accounted_;
  TransformCounts charged_;
};

}  // namespace carousel::ringbus

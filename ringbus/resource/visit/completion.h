#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/system/error.h"
#include "core/types/workload.h"
#include "ringbus/rays/ray_store.h"
#include "ringbus/resource/visit/transform_account.h"

namespace carousel::ringbus {

/// Counts the tests that each ray of a store still waits for, and takes a ray out of its slot when none is left
/// (docs/how-it-works/design.md, The way of a ray). The results and the free slots wait here until the engine takes
/// them away.
class Completion {
 public:
  /// Keeps references. `transforms` may be null.
  Completion(RayStore& store, TransformAccount* transforms) : store_(store), transforms_(transforms) {}

  /// Adds `change` to the count of the ray in `slot`, which may complete it.
  void add_pending(std::uint32_t slot, std::int32_t change) {
    RayRecord& record = store_.record(slot);
    record.pending += change;
    if constexpr (kChecked) {
      if (record.pending < 0)
        throw SimulationError("resource " + std::to_string(store_.owner().value) + " slot " + std::to_string(slot) +
                              ": more answers than pending tests");
    }
    if (record.pending == 0) complete(slot);
  }
  /// A slot, of a ray or a bundle, that ray control may hand out again.
  void free_slot(std::uint32_t slot) { freed_slots_.push_back(slot); }

  HitBatch& completed() { return completed_; }
  std::vector<std::uint32_t>& freed_slots() { return freed_slots_; }

  /// Forgets all rays, however far they are.
  void discard() {
    completed_.clear();
    freed_slots_.clear();
    if (transforms_ == nullptr) return;
    for (std::uint32_t slot = 0; slot < store_.slots(); ++slot) transforms_->forget(slot);
  }

 private:
  void complete(std::uint32_t slot) {
    store_.finish(slot, completed_);
    if (transforms_ != nullptr) transforms_->forget(slot);
    store_.retire(slot);
    freed_slots_.push_back(slot);
  }

  RayStore& store_;
  TransformAccount* transforms_;
  HitBatch completed_;
  std::vector<std::uint32_t> freed_slots_;
};

}  // namespace carousel::ringbus

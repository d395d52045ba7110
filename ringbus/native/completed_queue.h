#pragma once

#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/types/workload.h"

namespace carousel::ringbus {

/// Brings completed rays from any resource to any shader worker, a batch at a time. Batches hold some hundred rays, so
/// one lock a batch costs nothing that shows; emptied batches go back to be filled again.
class CompletedQueue {
 public:
  void push(HitBatch&& batch) {
    const std::lock_guard lock(mutex_);
    full_.push_back(std::move(batch));
  }
  std::optional<HitBatch> pop() {
    const std::lock_guard lock(mutex_);
    if (full_.empty()) return std::nullopt;
    HitBatch batch = std::move(full_.front());
    full_.pop_front();
    return batch;
  }
  /// An empty batch, with storage when one came back.
  HitBatch fresh() {
    const std::lock_guard lock(mutex_);
    if (empty_.empty()) return {};
    HitBatch batch = std::move(empty_.back());
    empty_.pop_back();
    return batch;
  }
  void give_back(HitBatch&& batch) {
    batch.clear();
    const std::lock_guard lock(mutex_);
    empty_.push_back(std::move(batch));
  }

 private:
  std::mutex mutex_;
  std::deque<HitBatch> full_;
  std::vector<HitBatch> empty_;
};

}  // namespace carousel::ringbus
